// SPDX-License-Identifier: MIT
// Seeding upstream of the lit box, and each particle's lit frames.
#include "simulation/tracers.hpp"

#include <algorithm>
#include <cmath>

#include "simulation/random.hpp"

namespace rptv {

namespace {
constexpr std::uint64_t kSeedingStream = std::uint64_t{4} << 56;

/// Interval of one axis that the particles of the run come from.
struct Extent {
  double low, high;
  Extent(double size, double path) : low(-0.5 * size - std::max(0.0, path)), high(0.5 * size - std::min(0.0, path)) {}
  double length() const noexcept { return high - low; }
};
}  // namespace

Tracers::Tracers(const ScenarioSettings& scenario)
    : scenario_(scenario), flow_(make_flow(scenario)), half_depth_(half_depth_mm(scenario)) {
  if (scenario.flow.kind == "random") return;
  if (scenario.flow.kind == "table")
    read_table();
  else if (scenario.flow.kind == "layers")
    seed_layers();
  else
    seed_box();
}

void Tracers::seed_layers() {
  Random random(static_cast<std::uint64_t>(scenario_.seed), kSeedingStream);
  const double half_x = 0.5 * scenario_.seeding.volume_x_mm, half_y = 0.5 * scenario_.seeding.volume_y_mm;
  for (const double z : scenario_.layers.z_mm)
    for (std::int64_t i = 0; i < scenario_.layers.particles_each; ++i) {
      const double x = random.uniform(-half_x, half_x);
      rest_.push_back({x, random.uniform(-half_y, half_y), z});
    }
  first_lit_.assign(rest_.size(), 0);
}

void Tracers::seed_box() {
  const auto& box = scenario_.seeding;
  const bool duct = scenario_.flow.kind == "duct";
  const double duration = time_s(static_cast<std::uint64_t>(scenario_.frames - 1));
  const Vector3 drift = flow_->largest_drift();
  const double depth = 2 * half_depth_, radius = box.particle_radius_um * 1e-3;
  const double top = duct ? 0.5 * std::min(box.volume_y_mm, scenario_.duct.width_mm) : 0.5 * box.volume_y_mm;
  const bool wall = scenario_.flow.kind == "oscillating_wall";
  const double bottom = wall ? std::max(-top, scenario_.flow.wall_y_mm + radius) : -top;
  const Extent x(box.volume_x_mm, drift.x * duration), z(depth, drift.z * duration);
  const double larger = x.length() * z.length() / (box.volume_x_mm * depth);
  const auto count = static_cast<std::size_t>(std::llround(static_cast<double>(box.particles) * larger));
  const auto frames = static_cast<std::uint64_t>(scenario_.frames);
  Random random(static_cast<std::uint64_t>(scenario_.seed), kSeedingStream);
  for (std::size_t i = 0; i < count; ++i) {
    Vector3 rest;
    rest.x = random.uniform(x.low, x.high);
    rest.y = random.uniform(bottom, top);
    rest.z = random.uniform(z.low, z.high);
    std::uint64_t frame = 0;
    rest_.push_back(rest);
    drift_.push_back(flow_->drift(rest));
    while (frame < frames && !is_lit(i, time_s(frame))) ++frame;
    first_lit_.push_back(frame);
  }
}

void Tracers::read_table() {
  const Measurement table = read_measurement(scenario_.flow.table);
  for (const TrackRow& row : table.rows) {
    auto& frame = table_[row.frame];
    const std::uint64_t particle = table.linked ? row.particle : frame.size();
    frame.push_back({particle, row.age, {row.x_mm, row.y_mm, row.z_mm}, {row.vx_mm_s, row.vy_mm_s, row.vz_mm_s}});
  }
}

bool Tracers::is_lit(std::size_t tracer, double time_s) const noexcept {
  const Vector3 &rest = rest_[tracer], &drift = drift_[tracer];
  return std::abs(rest.x + drift.x * time_s) <= 0.5 * scenario_.seeding.volume_x_mm &&
         std::abs(rest.z + drift.z * time_s) <= half_depth_;
}

std::vector<Tracer> Tracers::random_positions(std::uint64_t frame) const {
  const auto& box = scenario_.seeding;
  const auto count = static_cast<std::uint64_t>(box.particles);
  std::vector<Tracer> tracers(count);
  Random random(static_cast<std::uint64_t>(scenario_.seed), kSeedingStream + frame);
  for (std::uint64_t i = 0; i < count; ++i) {
    Vector3& at = tracers[i].position;
    tracers[i].particle = frame * count + i;
    at.x = 0.5 * random.uniform(-box.volume_x_mm, box.volume_x_mm);
    at.y = 0.5 * random.uniform(-box.volume_y_mm, box.volume_y_mm);
    at.z = 0.5 * random.uniform(-box.volume_z_mm, box.volume_z_mm);
  }
  return tracers;
}

std::vector<Tracer> Tracers::lit(std::uint64_t frame) const {
  if (scenario_.flow.kind == "random") return random_positions(frame);
  if (scenario_.flow.kind == "table") {
    const auto found = table_.find(frame);
    return found == table_.end() ? std::vector<Tracer>{} : found->second;
  }
  std::vector<Tracer> tracers;
  tracers.reserve(rest_.size());
  const double t = time_s(frame);
  const bool still = scenario_.flow.kind == "layers";  // their box is the layer itself
  for (std::size_t i = 0; i < rest_.size(); ++i)
    if (still || is_lit(i, t))
      tracers.push_back({i, frame - first_lit_[i], flow_->position(rest_[i], t), flow_->velocity(rest_[i], t)});
  return tracers;
}

TruthRow truth_row(const Tracer& tracer, std::uint64_t frame, double time_s) {
  TruthRow row;
  row.frame = frame;
  row.particle = tracer.particle;
  row.x_mm = tracer.position.x;
  row.y_mm = tracer.position.y;
  row.z_mm = tracer.position.z;
  row.vx_mm_s = tracer.velocity.x;
  row.vy_mm_s = tracer.velocity.y;
  row.vz_mm_s = tracer.velocity.z;
  row.age = tracer.age_frames;
  row.t_s = time_s;
  return row;
}

}  // namespace rptv
