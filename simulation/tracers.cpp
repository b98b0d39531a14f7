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

Tracers::Tracers(const ScenarioSettings& scenario) : scenario_(scenario), flow_(scenario.flow) {
  const auto& box = scenario.seeding;
  const double duration = time_s(static_cast<std::uint64_t>(scenario.frames - 1));
  const Extent x(box.volume_x_mm, scenario.flow.drift_x_mm_s * duration);
  const Extent z(box.volume_z_mm, scenario.flow.drift_z_mm_s * duration);
  const double radius = box.particle_radius_um * 1e-3;
  const double bottom = std::max(-0.5 * box.volume_y_mm, scenario.flow.wall_y_mm + radius);
  const double larger = x.length() * z.length() / (box.volume_x_mm * box.volume_z_mm);
  const auto count = static_cast<std::size_t>(std::llround(static_cast<double>(box.particles) * larger));
  Random random(static_cast<std::uint64_t>(scenario.seed), kSeedingStream);
  rest_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    Vector3 rest;
    rest.x = random.uniform(x.low, x.high);
    rest.y = random.uniform(bottom, 0.5 * box.volume_y_mm);
    rest.z = random.uniform(z.low, z.high);
    rest_.push_back(rest);
  }
  first_lit_.reserve(count);
  const auto frames = static_cast<std::uint64_t>(scenario.frames);
  for (const auto& rest : rest_) {
    std::uint64_t frame = 0;
    while (frame < frames && !is_lit(rest, time_s(frame))) ++frame;
    first_lit_.push_back(frame);
  }
}

bool Tracers::is_lit(const Vector3& rest, double time_s) const noexcept {
  const auto& box = scenario_.seeding;
  return std::abs(rest.x + scenario_.flow.drift_x_mm_s * time_s) <= 0.5 * box.volume_x_mm &&
         std::abs(rest.z + scenario_.flow.drift_z_mm_s * time_s) <= 0.5 * box.volume_z_mm;
}

std::vector<Tracer> Tracers::lit(std::uint64_t frame) const {
  std::vector<Tracer> tracers;
  tracers.reserve(rest_.size());
  const double t = time_s(frame);
  for (std::size_t i = 0; i < rest_.size(); ++i)
    if (is_lit(rest_[i], t))
      tracers.push_back({i, frame - first_lit_[i], flow_.position(rest_[i], t), flow_.velocity(rest_[i].y, t)});
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
