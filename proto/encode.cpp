// SPDX-License-Identifier: MIT
// Fills the protobuf messages from results and serialises them into one buffer.
#include "proto/encode.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <fstream>
#include <random>
#include <tuple>
#include <vector>

#include "core/clock.hpp"
#include "core/error.hpp"
#include "rapidptv.pb.h"

namespace rptv {
namespace {

static_assert(std::endian::native == std::endian::little, "columns are little-endian: swap bytes in fill_column");

constexpr std::size_t kBytesPerTrack = 8 + 7 * 4 + 4 + 21 * 4 + 2 * 8;  // columns of Tracks, births, deaths
constexpr std::size_t kBytesPerParticle = 5 * 4 + 6 * 4;
constexpr std::size_t kEnvelopeBytes = 4096;  // session, stamps, tags and lengths need a few hundred

/// Never allocates once `column` has been reserved for the capacity.
template <class Wire, class Value>
void fill_column(std::string& column, const std::vector<Value>& values) noexcept {
  column.resize(values.size() * sizeof(Wire));
  char* out = column.data();
  for (const Value& value : values) {
    const Wire wire = static_cast<Wire>(value);
    std::memcpy(out, &wire, sizeof wire);
    out += sizeof wire;
  }
}

/// Several floats per row: numbers_of(value) is an array of them.
template <class Value, class NumbersOf>
void fill_rows(std::string& column, const std::vector<Value>& values, NumbersOf&& numbers_of) noexcept {
  column.resize(values.size() * sizeof(float) * std::tuple_size_v<std::decay_t<decltype(numbers_of(values[0]))>>);
  char* out = column.data();
  for (const Value& value : values) {
    for (const double element : numbers_of(value)) {
      const auto wire = static_cast<float>(element);
      std::memcpy(out, &wire, sizeof wire);
      out += sizeof wire;
    }
  }
}

void fill_estimates(rapidptv::Tracks& to, const std::vector<TrackEstimate>& from) noexcept {
  using E = const TrackEstimate&;
  fill_rows(*to.mutable_acceleration(), from, [](E e) { return std::array{e.ax_mm_s2, e.ay_mm_s2, e.az_mm_s2}; });
  fill_rows(*to.mutable_position_covariance(), from, [](E e) { return e.position_mm2; });
  fill_rows(*to.mutable_velocity_covariance(), from, [](E e) { return e.velocity_mm2_s2; });
  fill_rows(*to.mutable_acceleration_covariance(), from, [](E e) { return e.acceleration_mm2_s4; });
}

void reserve_all(std::initializer_list<std::string*> columns, std::size_t bytes) {
  for (std::string* column : columns) column->reserve(bytes);
}

void fill_stamps(rapidptv::Stamps& out, const Stamps& stamps) noexcept {
  out.set_exposure_end(stamps[Stage::exposure_end]);
  out.set_arrived(stamps[Stage::arrived]);
  out.set_bundled(stamps[Stage::bundled]);
  out.set_reconstructed(stamps[Stage::reconstructed]);
  out.set_linked(stamps[Stage::linked]);
  out.set_published(stamps[Stage::published]);
}

void fill_status(rapidptv::Status& out, const StatusReport& report) {
  out.Clear();
  out.set_state(static_cast<rapidptv::State>(report.state));
  out.set_frames_in(report.frames_in);
  out.set_results_out(report.results_out);
  out.set_messages_sent(report.messages_sent);
  out.set_queue_full(report.queue_full);
  out.set_input_hz(report.input_hz);
  out.set_output_hz(report.output_hz);
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const LatencySummary& summary = report.latency[i];
    auto& latency = *out.add_latency();
    latency.set_stage(std::string(name_of(static_cast<Stage>(i))));
    latency.set_count(summary.count);
    latency.set_p50_ns(summary.p50_ns);
    latency.set_p99_ns(summary.p99_ns);
    latency.set_p999_ns(summary.p999_ns);
    latency.set_max_ns(summary.max_ns);
  }
  for (const LossCount& loss : report.losses) {
    auto& entry = *out.add_losses();
    entry.set_place(loss.place);
    entry.set_cause(std::string(name_of(loss.cause)));
    entry.set_count(loss.count);
  }
  for (const QueueFill& queue : report.queues) {
    auto& entry = *out.add_queues();
    entry.set_name(queue.name);
    entry.set_waiting(queue.waiting);
    entry.set_capacity(queue.capacity);
  }
  for (const std::string& warning : report.warnings) out.add_warnings(warning);
  for (const CameraReport& camera : report.cameras) write_camera(camera, *out.add_cameras());
  if (report.drift.watched) write_drift(report.drift, *out.mutable_drift());
}

}  // namespace

struct Encoder::Messages {
  std::array<rapidptv::Envelope, kTopicCount> by_topic;
  std::array<std::uint64_t, kTopicCount> sequence{};
  std::vector<std::byte> buffer;

  /// The topic's message with its sequence number. Only overwritten, never Clear()ed: that would free the submessages.
  rapidptv::Envelope& begin(Topic topic) noexcept {
    auto& envelope = by_topic[static_cast<std::size_t>(topic)];
    envelope.set_sequence(sequence[static_cast<std::size_t>(topic)]++);
    return envelope;
  }

  static void fill_frame(rapidptv::Envelope& envelope, const Result& result, Stamps& stamps) noexcept {
    envelope.set_frame(result.frame);
    envelope.set_exposure_end_ns(result.exposure_end_ns);
    envelope.set_clock(static_cast<rapidptv::Clock>(result.clock));
    stamps[Stage::published] = host_now_ns();
    fill_stamps(*envelope.mutable_stamps(), stamps);
  }

  std::span<const std::byte> serialise(const rapidptv::Envelope& envelope) {
    const std::size_t bytes = envelope.ByteSizeLong();
    if (bytes > buffer.size()) buffer.resize(bytes);  // status and rig only: the columns' capacities are in it
    envelope.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(buffer.data()));
    return {buffer.data(), bytes};
  }
};

Encoder::Encoder(std::string_view session, std::size_t particle_capacity, std::size_t track_capacity)
    : messages_(std::make_unique<Messages>()) {
  const std::size_t bytes =
      kEnvelopeBytes + std::max(particle_capacity * kBytesPerParticle, track_capacity * kBytesPerTrack);
  if (bytes > std::size_t{INT32_MAX})
    throw Error(ExitCode::configuration, "a message of " + std::to_string(bytes) +
                                             " bytes does not fit into protobuf's 2 GiB; lower the capacity of "
                                             "particles and tracks");
  messages_->buffer.resize(bytes);
  const std::string boot_id = read_boot_id();
  for (auto& envelope : messages_->by_topic) {
    envelope.set_schema(kWireSchema);
    envelope.set_session(std::string(session));
    envelope.set_boot_id(boot_id);
  }
  auto& tracks = messages_->by_topic[static_cast<std::size_t>(Topic::tracks)];
  reserve_all({tracks.mutable_births(), tracks.mutable_deaths(), tracks.mutable_tracks()->mutable_id()},
              track_capacity * 8);
  auto& t = *tracks.mutable_tracks();
  reserve_all({t.mutable_x(), t.mutable_y(), t.mutable_z(), t.mutable_vx(), t.mutable_vy(), t.mutable_vz(),
               t.mutable_residual(), t.mutable_age()},
              track_capacity * 4);
  reserve_all({t.mutable_acceleration()}, track_capacity * 12);
  reserve_all({t.mutable_position_covariance(), t.mutable_velocity_covariance(), t.mutable_acceleration_covariance()},
              track_capacity * 24);
  tracks.mutable_stamps();
  auto& particles = messages_->by_topic[static_cast<std::size_t>(Topic::particles)];
  auto& p = *particles.mutable_particles();
  reserve_all(
      {p.mutable_x(), p.mutable_y(), p.mutable_z(), p.mutable_residual(), p.mutable_support(), p.mutable_ghost()},
      particle_capacity * 4);
  p.mutable_covariance()->reserve(particle_capacity * 24);
  particles.mutable_stamps();
}

Encoder::~Encoder() = default;

std::span<const std::byte> Encoder::tracks(const Result& result, Stamps& stamps) noexcept {
  auto& envelope = messages_->begin(Topic::tracks);
  const Tracks& from = result.tracks;
  auto& to = *envelope.mutable_tracks();
  fill_column<std::uint64_t>(*to.mutable_id(), from.particle);
  fill_column<float>(*to.mutable_x(), from.x_mm);
  fill_column<float>(*to.mutable_y(), from.y_mm);
  fill_column<float>(*to.mutable_z(), from.z_mm);
  fill_column<float>(*to.mutable_vx(), from.vx_mm_s);
  fill_column<float>(*to.mutable_vy(), from.vy_mm_s);
  fill_column<float>(*to.mutable_vz(), from.vz_mm_s);
  fill_column<float>(*to.mutable_residual(), from.residual_mm);
  fill_column<std::uint32_t>(*to.mutable_age(), from.age_frames);
  fill_estimates(to, from.estimate);
  to.set_adapted_subnets(from.adapted_subnets);
  to.set_cut_subnets(from.cut_subnets);
  fill_column<std::uint64_t>(*envelope.mutable_births(), from.births);
  fill_column<std::uint64_t>(*envelope.mutable_deaths(), from.deaths);
  Messages::fill_frame(envelope, result, stamps);
  return messages_->serialise(envelope);
}

std::span<const std::byte> Encoder::particles(const Result& result, Stamps& stamps) noexcept {
  auto& envelope = messages_->begin(Topic::particles);
  const Particles& from = result.particles;
  auto& to = *envelope.mutable_particles();
  fill_column<float>(*to.mutable_x(), from.x_mm);
  fill_column<float>(*to.mutable_y(), from.y_mm);
  fill_column<float>(*to.mutable_z(), from.z_mm);
  fill_column<float>(*to.mutable_residual(), from.residual_mm);
  fill_column<float>(*to.mutable_support(), from.support);
  fill_column<float>(*to.mutable_ghost(), from.ghost);
  fill_rows(*to.mutable_covariance(), from.covariance_mm2, [](const Covariance& c) { return c; });
  Messages::fill_frame(envelope, result, stamps);
  return messages_->serialise(envelope);
}

std::span<const std::byte> Encoder::status(const StatusReport& report) {
  auto& envelope = messages_->begin(Topic::status);
  fill_status(*envelope.mutable_status(), report);
  return messages_->serialise(envelope);
}

std::span<const std::byte> Encoder::rig(std::string_view calibration, std::string_view config) {
  auto& envelope = messages_->begin(Topic::rig);
  envelope.mutable_rig()->set_calibration(std::string(calibration));
  envelope.mutable_rig()->set_config(std::string(config));
  return messages_->serialise(envelope);
}

std::string make_session_name() {
  std::random_device random;
  std::string name;
  for (int i = 0; i < 32; ++i) name += "0123456789abcdef"[random() & 15U];
  return name;
}

std::string read_boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  return id;
}

}  // namespace rptv
