// SPDX-License-Identifier: MIT
// Reads a published message back into plain structs, trusting nothing in it.
#include <algorithm>
#include <cstring>

#include "proto/encode.hpp"
#include "rapidptv.pb.h"

namespace rptv {
namespace {

/// False when `column` does not hold whole elements.
template <class Value>
bool read_column(const std::string& column, std::vector<Value>& values) {
  if (column.size() % sizeof(Value) != 0) return false;
  values.resize(column.size() / sizeof(Value));
  if (!values.empty()) std::memcpy(values.data(), column.data(), column.size());
  return true;
}

bool all_of_size(std::size_t size, std::initializer_list<const std::vector<float>*> columns) {
  return std::all_of(columns.begin(), columns.end(), [size](const auto* column) { return column->size() == size; });
}

bool read_estimates(const rapidptv::Tracks& from, TracksColumns& to) {
  to.adapted_subnets = from.adapted_subnets();
  to.cut_subnets = from.cut_subnets();
  const auto fits = [&](std::size_t size) { return size == 0 || size == to.id.size(); };
  return read_column(from.acceleration(), to.acceleration_mm_s2) &&
         read_column(from.position_covariance(), to.position_covariance_mm2) &&
         read_column(from.velocity_covariance(), to.velocity_covariance_mm2_s2) &&
         read_column(from.acceleration_covariance(), to.acceleration_covariance_mm2_s4) &&
         fits(to.acceleration_mm_s2.size()) && fits(to.position_covariance_mm2.size()) &&
         fits(to.velocity_covariance_mm2_s2.size()) && fits(to.acceleration_covariance_mm2_s4.size());
}

bool read_tracks(const rapidptv::Tracks& from, TracksColumns& to) {
  return read_column(from.id(), to.id) && read_column(from.x(), to.x_mm) && read_column(from.y(), to.y_mm) &&
         read_column(from.z(), to.z_mm) && read_column(from.vx(), to.vx_mm_s) && read_column(from.vy(), to.vy_mm_s) &&
         read_column(from.vz(), to.vz_mm_s) && read_column(from.residual(), to.residual_mm) &&
         read_column(from.age(), to.age_frames) && to.age_frames.size() == to.id.size() &&
         all_of_size(to.id.size(),
                     {&to.x_mm, &to.y_mm, &to.z_mm, &to.vx_mm_s, &to.vy_mm_s, &to.vz_mm_s, &to.residual_mm}) &&
         read_estimates(from, to);
}

bool read_particles(const rapidptv::Particles& from, ParticlesColumns& to) {
  return read_column(from.x(), to.x_mm) && read_column(from.y(), to.y_mm) && read_column(from.z(), to.z_mm) &&
         read_column(from.residual(), to.residual_mm) && read_column(from.support(), to.support) &&
         read_column(from.ghost(), to.ghost) && read_column(from.covariance(), to.covariance_mm2) &&
         to.covariance_mm2.size() == to.x_mm.size() &&
         all_of_size(to.x_mm.size(), {&to.y_mm, &to.z_mm, &to.residual_mm, &to.support}) &&
         (to.ghost.empty() || to.ghost.size() == to.x_mm.size());
}

template <class Name, std::size_t Count>
bool read_name(const std::string& text, Name& name) {
  for (std::size_t i = 0; i < Count; ++i) {
    name = static_cast<Name>(i);
    if (name_of(name) == text) return true;
  }
  return false;
}

/// Stages and causes that this reader does not know are left out: a newer daemon may have more of them.
bool read_status(const rapidptv::Status& from, StatusReport& to) {
  if (from.state() < 0 || static_cast<std::size_t>(from.state()) >= kRunStateCount) return false;
  to.state = static_cast<RunState>(from.state());
  to.frames_in = from.frames_in();
  to.results_out = from.results_out();
  to.messages_sent = from.messages_sent();
  to.queue_full = from.queue_full();
  to.input_hz = from.input_hz();
  to.output_hz = from.output_hz();
  for (const auto& latency : from.latency()) {
    Stage stage{};
    if (!read_name<Stage, kStageCount>(latency.stage(), stage)) continue;
    to.latency[static_cast<std::size_t>(stage)] = {.count = latency.count(),
                                                   .p50_ns = latency.p50_ns(),
                                                   .p99_ns = latency.p99_ns(),
                                                   .p999_ns = latency.p999_ns(),
                                                   .max_ns = latency.max_ns()};
  }
  for (const auto& loss : from.losses()) {
    LossCause cause{};
    if (read_name<LossCause, kLossCauseCount>(loss.cause(), cause))
      to.losses.push_back({.place = loss.place(), .cause = cause, .count = loss.count()});
  }
  for (const auto& queue : from.queues())
    to.queues.push_back({.name = queue.name(), .waiting = queue.waiting(), .capacity = queue.capacity()});
  to.warnings.assign(from.warnings().begin(), from.warnings().end());
  for (const auto& camera : from.cameras()) to.cameras.push_back(read_camera(camera));
  if (from.has_drift()) to.drift = read_drift(from.drift());
  return true;
}

Stamps read_stamps(const rapidptv::Stamps& from) {
  Stamps to;
  to[Stage::exposure_end] = from.exposure_end();
  to[Stage::arrived] = from.arrived();
  to[Stage::bundled] = from.bundled();
  to[Stage::reconstructed] = from.reconstructed();
  to[Stage::linked] = from.linked();
  to[Stage::published] = from.published();
  return to;
}

std::string read_content(const rapidptv::Envelope& from, WireMessage& to) {
  const int contents = from.has_tracks() + from.has_particles() + from.has_status() + from.has_rig();
  if (contents != 1) return "message holds " + std::to_string(contents) + " contents instead of one";
  if (from.has_tracks() && !read_tracks(from.tracks(), to.content.emplace<TracksColumns>()))
    return "columns of the tracks differ in length";
  if (from.has_particles() && !read_particles(from.particles(), to.content.emplace<ParticlesColumns>()))
    return "columns of the particles differ in length";
  if (from.has_status() && !read_status(from.status(), to.content.emplace<StatusReport>()))
    return "state " + std::to_string(from.status().state()) + " is unknown; update rapidptv";
  if (from.has_rig()) to.content = RigTexts{from.rig().calibration(), from.rig().config()};
  return {};
}

}  // namespace

std::string decode(std::span<const std::byte> bytes, WireMessage& message) {
  rapidptv::Envelope envelope;
  if (bytes.size() > std::size_t{INT32_MAX} || !envelope.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())))
    return "message is not a rapidptv.Envelope; is another program publishing on this endpoint?";
  if (envelope.schema() == 0) return "message has no schema; is another program publishing on this endpoint?";
  if (envelope.schema() > kWireSchema)
    return "message has schema " + std::to_string(envelope.schema()) + ", this program reads up to " +
           std::to_string(kWireSchema) + "; update rapidptv";
  if (envelope.clock() < 0 || envelope.clock() > static_cast<int>(ClockId::nominal))
    return "clock " + std::to_string(envelope.clock()) + " is unknown; update rapidptv";
  message.schema = envelope.schema();
  message.session = envelope.session();
  message.boot_id = envelope.boot_id();
  message.sequence = envelope.sequence();
  message.frame = envelope.frame();
  message.exposure_end_ns = envelope.exposure_end_ns();
  message.clock = static_cast<ClockId>(envelope.clock());
  message.stamps = read_stamps(envelope.stamps());
  // CLOCK_MONOTONIC is never negative; without negative ones no difference of two stamps can overflow.
  if (std::any_of(message.stamps.at_ns.begin(), message.stamps.at_ns.end(), [](auto at_ns) { return at_ns < 0; }))
    return "a stage's time stamp is negative";
  if (!read_column(envelope.births(), message.births) || !read_column(envelope.deaths(), message.deaths))
    return "births or deaths are no whole numbers";
  return read_content(envelope, message);
}

}  // namespace rptv
