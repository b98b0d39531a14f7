// SPDX-License-Identifier: MIT
// A run's report as text and as JSON.
#include <fmt/format.h>

#include "core/json.hpp"
#include "daemon/backend.hpp"
#include "daemon/loss_advice.hpp"
#include "daemon/session.hpp"

namespace rptv {
namespace {

double milliseconds(std::int64_t ns) noexcept { return static_cast<double>(ns) * 1e-6; }

}  // namespace

std::string to_text(const SessionReport& report) {
  const PipelineCounts& n = report.counts;
  std::string text = fmt::format("{} frames in {:.2f} s ({:.1f} Hz): {} particles, {} track points, {} tracks\n",
                                 n.linked, report.elapsed_s, static_cast<double>(n.linked) / report.elapsed_s,
                                 n.particles, n.track_points, n.births);
  text += "latency from exposure end, ms          P50      P99    P99.9      max\n";
  for (std::size_t i = 1; i < kStageCount; ++i) {
    const LatencySummary& l = report.latency[i];
    if (l.count == 0) continue;
    text +=
        fmt::format("  {:<32} {:>8.3f} {:>8.3f} {:>8.3f} {:>8.3f}\n", name_of(static_cast<Stage>(i)),
                    milliseconds(l.p50_ns), milliseconds(l.p99_ns), milliseconds(l.p999_ns), milliseconds(l.max_ns));
  }
  if (report.losses.empty()) text += "losses: none\n";
  for (const LossCount& loss : report.losses) {
    const std::string_view advice = advice_on(loss.cause);
    text += fmt::format("lost: {} × {} at {}{}{}\n", loss.count, name_of(loss.cause), loss.place,
                        advice.empty() ? "" : ": ", advice);
  }
  for (const CameraReport& camera : report.cameras) text += to_line(camera) + "\n";
  if (report.sets_without_device > 0) text += device_failure(report.sets_without_device) + "\n";
  if (!report.source_failure.empty()) text += "source failed: " + report.source_failure + "\n";
  return text;
}

std::string to_json(const SessionReport& report) {
  const PipelineCounts& n = report.counts;
  std::string json = fmt::format(
      R"({{"frames_arrived":{},"frames":{},"elapsed_s":{:.6f},"particles":{},"track_points":{},"tracks":{},"links":{},"latency_ns":{{)",
      n.arrived, n.linked, report.elapsed_s, n.particles, n.track_points, n.births, report.linker.links);
  for (std::size_t i = 1; i < kStageCount; ++i) {
    const LatencySummary& l = report.latency[i];
    json += fmt::format(R"({}"{}":{{"count":{},"p50":{},"p99":{},"p99_9":{},"max":{}}})", i > 1 ? "," : "",
                        name_of(static_cast<Stage>(i)), l.count, l.p50_ns, l.p99_ns, l.p999_ns, l.max_ns);
  }
  json += R"(},"losses":[)";
  for (std::size_t i = 0; i < report.losses.size(); ++i) {
    const LossCount& loss = report.losses[i];
    json += fmt::format(R"({}{{"place":{},"cause":"{}","count":{}}})", i > 0 ? "," : "", json_string(loss.place),
                        name_of(loss.cause), loss.count);
  }
  json += R"(],"cameras":[)";
  for (std::size_t i = 0; i < report.cameras.size(); ++i) json += (i > 0 ? "," : "") + to_json(report.cameras[i]);
  return json + fmt::format(R"(],"sets_without_device":{},"source_failure":{}}})", report.sets_without_device,
                            json_string(report.source_failure));
}

}  // namespace rptv
