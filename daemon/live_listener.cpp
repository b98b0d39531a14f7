// SPDX-License-Identifier: MIT
// Receiving and tabulating behind daemon/live_listener.hpp.
#include "daemon/live_listener.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "proto/encode.hpp"

namespace rptv {
namespace {

std::string row(std::string_view name, const LatencyHistogram& histogram) {
  const auto ms = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-6; };
  return fmt::format("  {:<22} {:>9.3f} {:>9.3f} {:>9.3f} {:>9.3f}\n", name, ms(histogram.percentile_ns(0.5)),
                     ms(histogram.percentile_ns(0.99)), ms(histogram.percentile_ns(0.999)), ms(histogram.max_ns()));
}

}  // namespace

LiveListener::LiveListener(const std::string& endpoint)
    : channel_({.endpoint = endpoint,
                .topics = {Topic::tracks, Topic::status},
                .curve_server_key = {},
                .high_water_mark = 10000}) {}

bool LiveListener::poll(int timeout_ms) {
  Topic topic{};
  std::span<const std::byte> body;
  if (!channel_.receive(topic, body, timeout_ms)) return false;
  const std::int64_t now_ns = host_now_ns();
  if (const std::string fault = decode(body, message_); !fault.empty())
    throw Error(ExitCode::bad_data, "live stream: " + fault + "; is an older or newer rapidptv publishing there?");
  if (const auto* status = std::get_if<StatusReport>(&message_.content)) status_ = *status;
  const auto* tracks = std::get_if<TracksColumns>(&message_.content);
  if (tracks == nullptr) return true;
  if (frames_ == 0) first_frame_ = message_.frame;
  last_frame_ = message_.frame;
  ++frames_;
  track_points_ += tracks->id.size();
  const std::int64_t exposed_ns = message_.stamps[Stage::exposure_end];
  for (std::size_t s = 1; s < kStageCount; ++s) stages_[s].record(message_.stamps[static_cast<Stage>(s)] - exposed_ns);
  received_.record(now_ns - exposed_ns);
  return true;
}

std::string LiveListener::latency_table() const {
  std::string table = "  exposure end → …, ms         P50       P99     P99.9       max\n";
  for (std::size_t s = 1; s < kStageCount; ++s) table += row(name_of(static_cast<Stage>(s)), stages_[s]);
  return table + row("subscriber", received_);
}

}  // namespace rptv
