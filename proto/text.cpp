// SPDX-License-Identifier: MIT
// Lines and JSON from wire messages.
#include "proto/text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "core/json.hpp"

namespace rptv {
namespace {

using Buffer = fmt::memory_buffer;

template <class... Args>
void put(Buffer& out, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
}

std::string_view name_of_clock(ClockId clock) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"host_monotonic", "device", "ptp", "recording", "nominal"};
  return kNames[static_cast<std::size_t>(clock)];
}

double ms(std::int64_t ns) noexcept { return static_cast<double>(ns) * 1e-6; }

void put_text(Buffer& out, std::string_view text) {
  const std::string quoted = json_string(text);
  out.append(quoted.data(), quoted.data() + quoted.size());
}

template <class Value>
void put_number(Buffer& out, Value value) {
  if constexpr (std::is_floating_point_v<Value>) {
    if (!std::isfinite(value)) return put(out, "null");
  }
  put(out, "{}", value);
}

template <class Range, class Put>
void put_list(Buffer& out, const Range& values, Put put_one) {
  out.push_back('[');
  bool first = true;
  for (const auto& value : values) {
    if (!first) out.push_back(',');
    first = false;
    put_one(value);
  }
  out.push_back(']');
}

template <class Value>
void put_column(Buffer& out, std::string_view name, const std::vector<Value>& values) {
  put(out, ",\"{}\":", name);
  put_list(out, values, [&](Value value) { put_number(out, value); });
}

template <class Rows>
void put_rows(Buffer& out, std::string_view name, const Rows& rows) {
  put(out, ",\"{}\":", name);
  put_list(out, rows, [&](const auto& row) { put_list(out, row, [&](float value) { put_number(out, value); }); });
}

void put_content(Buffer& out, const TracksColumns& tracks) {
  put_column(out, "particle", tracks.id);
  put_column(out, "x", tracks.x_mm);
  put_column(out, "y", tracks.y_mm);
  put_column(out, "z", tracks.z_mm);
  put_column(out, "vx", tracks.vx_mm_s);
  put_column(out, "vy", tracks.vy_mm_s);
  put_column(out, "vz", tracks.vz_mm_s);
  put_column(out, "residual", tracks.residual_mm);
  put_column(out, "age", tracks.age_frames);
  if (!tracks.acceleration_mm_s2.empty()) {
    put_rows(out, "acceleration", tracks.acceleration_mm_s2);
    put_rows(out, "position_covariance", tracks.position_covariance_mm2);
    put_rows(out, "velocity_covariance", tracks.velocity_covariance_mm2_s2);
    put_rows(out, "acceleration_covariance", tracks.acceleration_covariance_mm2_s4);
  }
  put(out, R"(,"adapted_subnets":{},"cut_subnets":{})", tracks.adapted_subnets, tracks.cut_subnets);
}

void put_content(Buffer& out, const ParticlesColumns& particles) {
  put_column(out, "x", particles.x_mm);
  put_column(out, "y", particles.y_mm);
  put_column(out, "z", particles.z_mm);
  put_column(out, "residual", particles.residual_mm);
  put_column(out, "support", particles.support);
  put_rows(out, "covariance", particles.covariance_mm2);
  if (!particles.ghost.empty()) put_column(out, "ghost", particles.ghost);
}

void put_latency(Buffer& out, std::string_view stage, const LatencySummary& s) {
  put(out, R"({{"stage":"{}","count":{},"p50_ns":{},"p99_ns":{},"p999_ns":{},"max_ns":{}}})", stage, s.count, s.p50_ns,
      s.p99_ns, s.p999_ns, s.max_ns);
}

void put_content(Buffer& out, const StatusReport& status) {
  put(out, R"(,"state":"{}","frames_in":{},"results_out":{},"messages_sent":{},"queue_full":{})", name_of(status.state),
      status.frames_in, status.results_out, status.messages_sent, status.queue_full);
  put(out, R"(,"input_hz":)");
  put_number(out, status.input_hz);
  put(out, R"(,"output_hz":)");
  put_number(out, status.output_hz);
  put(out, R"(,"latency":)");
  std::size_t stage = 0;
  put_list(out, status.latency, [&](const auto& s) { put_latency(out, name_of(static_cast<Stage>(stage++)), s); });
  put(out, R"(,"losses":)");
  put_list(out, status.losses, [&](const LossCount& loss) {
    put(out, R"({{"place":)");
    put_text(out, loss.place);
    put(out, R"(,"cause":"{}","count":{}}})", name_of(loss.cause), loss.count);
  });
  put(out, R"(,"queues":)");
  put_list(out, status.queues, [&](const QueueFill& queue) {
    put(out, R"({{"name":)");
    put_text(out, queue.name);
    put(out, R"(,"waiting":{},"capacity":{}}})", queue.waiting, queue.capacity);
  });
  put(out, R"(,"warnings":)");
  put_list(out, status.warnings, [&](const std::string& warning) { put_text(out, warning); });
  put(out, R"(,"cameras":)");
  put_list(out, status.cameras, [&](const CameraReport& camera) { put(out, "{}", to_json(camera)); });
  put(out, R"(,"drift":{})", to_json(status.drift));
}

void put_content(Buffer& out, const RigTexts& rig) {
  put(out, R"(,"calibration":)");
  put_text(out, rig.calibration);
  put(out, R"(,"config":)");
  put_text(out, rig.config);
}

/// Tracks and particles: when, and when each stage was done.
void put_frame(Buffer& out, const WireMessage& message, std::int64_t received_ns) {
  put(out, R"(,"frame":{},"exposure_end_ns":{},"clock":"{}","stamps_ns":{{)", message.frame, message.exposure_end_ns,
      name_of_clock(message.clock));
  for (std::size_t i = 0; i < kStageCount; ++i)
    put(out, R"("{}":{},)", name_of(static_cast<Stage>(i)), message.stamps.at_ns[i]);
  put(out, R"("received":{}}})", received_ns);
  put_column(out, "births", message.births);
  put_column(out, "deaths", message.deaths);
}

Topic topic_of(const WireMessage& message) noexcept { return static_cast<Topic>(message.content.index()); }
bool has_frame(const WireMessage& message) noexcept {
  return topic_of(message) == Topic::tracks || topic_of(message) == Topic::particles;
}

std::string frame_line(const WireMessage& message, std::int64_t received_ns) {
  Buffer out;
  put(out, "frame {}  t {:.6f} s  ", message.frame, static_cast<double>(message.exposure_end_ns) * 1e-9);
  if (const auto* tracks = std::get_if<TracksColumns>(&message.content))
    put(out, "tracks {}  births {}  deaths {}", tracks->id.size(), message.births.size(), message.deaths.size());
  if (const auto* particles = std::get_if<ParticlesColumns>(&message.content))
    put(out, "particles {}", particles->x_mm.size());
  const std::int64_t from_ns = message.stamps[Stage::exposure_end];
  const std::int64_t to_ns = received_ns != 0 ? received_ns : message.stamps[Stage::published];
  if (from_ns != 0 && to_ns != 0) put(out, "  latency {:.3f} ms", ms(to_ns - from_ns));
  return to_string(out);
}

std::string status_line(const StatusReport& status) {
  Buffer out;
  put(out, "{}  in {} frames ({:.1f} Hz)  out {} ({:.1f} Hz)", name_of(status.state), status.frames_in, status.input_hz,
      status.results_out, status.output_hz);
  const LatencySummary& published = status.latency[static_cast<std::size_t>(Stage::published)];
  if (published.count != 0)
    put(out, "  latency P50 {:.3f} P99 {:.3f} max {:.3f} ms", ms(published.p50_ns), ms(published.p99_ns),
        ms(published.max_ns));
  for (const LossCount& loss : status.losses)
    if (loss.count != 0) put(out, "  lost {} {} ({})", loss.count, name_of(loss.cause), loss.place);
  for (const std::string& warning : status.warnings) put(out, "  warning: {}", warning);
  for (const CameraReport& camera : status.cameras) put(out, "  {}", to_line(camera));
  if (status.drift.watched) put(out, "  {}", to_line(status.drift));
  return to_string(out);
}

void put_row(Buffer& out, std::string_view name, const LatencyHistogram& histogram) {
  const LatencySummary s = summary_of(histogram);
  put(out, "{:<14}{:>10}{:>11.3f}{:>11.3f}{:>11.3f}{:>11.3f}\n", name, s.count, ms(s.p50_ns), ms(s.p99_ns),
      ms(s.p999_ns), ms(s.max_ns));
}

}  // namespace

std::string to_line(const WireMessage& message, std::int64_t received_ns) {
  if (const auto* status = std::get_if<StatusReport>(&message.content)) return status_line(*status);
  if (const auto* rig = std::get_if<RigTexts>(&message.content))
    return "# calibration\n" + rig->calibration + "\n# configuration\n" + rig->config;
  return frame_line(message, received_ns);
}

std::string to_json(const WireMessage& message, std::int64_t received_ns) {
  Buffer out;
  put(out, R"({{"topic":"{}","schema":{},"session":)", name_of(topic_of(message)), message.schema);
  put_text(out, message.session);
  put(out, R"(,"sequence":{})", message.sequence);
  if (has_frame(message)) put_frame(out, message, received_ns);
  std::visit([&out](const auto& content) { put_content(out, content); }, message.content);
  out.push_back('}');
  return to_string(out);
}

void ReceivedLatency::record(const WireMessage& message, std::int64_t received_ns) noexcept {
  const std::int64_t from_ns = message.stamps[Stage::exposure_end];
  if (!has_frame(message) || from_ns == 0) return;
  for (std::size_t i = 1; i < kStageCount; ++i)
    if (message.stamps.at_ns[i] != 0) stages_[i].record(message.stamps.at_ns[i] - from_ns);
  if (received_ns != 0) received_.record(received_ns - from_ns);
}

std::string ReceivedLatency::table() const {
  Buffer out;
  put(out, "{:<14}{:>10}{:>11}{:>11}{:>11}{:>11}\n", "exposure end →", "  frames", "P50 ms", "P99 ms", "P99.9 ms",
      "max ms");
  for (std::size_t i = 1; i < kStageCount; ++i)
    if (stages_[i].count() != 0) put_row(out, name_of(static_cast<Stage>(i)), stages_[i]);
  if (received_.count() != 0) put_row(out, "received", received_);
  return to_string(out);
}

std::string ReceivedLatency::json() const {
  Buffer out;
  put(out, R"({{"latency":[)");
  for (std::size_t i = 1; i < kStageCount; ++i) {
    put_latency(out, name_of(static_cast<Stage>(i)), summary_of(stages_[i]));
    out.push_back(',');
  }
  put_latency(out, "received", summary_of(received_));
  put(out, "]}}");
  return to_string(out);
}

std::uint64_t SequenceCheck::missing_before(Topic topic, const WireMessage& message) {
  const auto t = static_cast<std::size_t>(topic);
  if (message.session != session_) {
    session_ = message.session;
    started_ = {};
  }
  const std::uint64_t missing = started_[t] && message.sequence > expected_[t] ? message.sequence - expected_[t] : 0;
  started_[t] = true;
  expected_[t] = message.sequence + 1;
  missing_ += missing;
  return missing;
}

}  // namespace rptv
