// SPDX-License-Identifier: MIT
// Results with known numbers for the tests of the wire.
#pragma once

#include <random>

#include "core/result.hpp"

namespace rptv {

/// Fills `result` with `tracks` tracks (ids from `first_id`) and as many particles, stamped as by a pipeline. The
/// numbers are floats, so that they survive the wire exactly.
inline void fill_result(Result& result, std::uint64_t frame, std::size_t tracks, std::uint64_t first_id = 1,
                        unsigned seed = 1, bool filtered = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> mm(-3.5F, 3.5F);
  const auto number = [&] { return static_cast<double>(mm(random)); };
  result.frame = frame;
  result.exposure_end_ns = static_cast<std::int64_t>(frame) * 10'000'000;
  result.clock = ClockId::recording;
  const std::int64_t now_ns = host_now_ns();
  for (std::size_t s = 0; s < kStageCount - 1; ++s)
    result.stamps.at_ns[s] = now_ns - 5'000'000 + static_cast<std::int64_t>(s) * 1'000'000;
  result.stamps[Stage::published] = 0;
  result.particles.clear();
  result.tracks.clear();
  for (std::size_t i = 0; i < tracks; ++i) {
    const Particle particle{.x_mm = number(),
                            .y_mm = number(),
                            .z_mm = number(),
                            .residual_mm = number(),
                            .support = static_cast<double>(i + 3),
                            .covariance_mm2 = {number(), number(), number(), number(), number(), number()},
                            .ghost = number()};
    result.particles.push(particle);
    result.tracks.push({.particle = first_id + i,
                        .x_mm = particle.x_mm,
                        .y_mm = particle.y_mm,
                        .z_mm = particle.z_mm,
                        .vx_mm_s = number(),
                        .vy_mm_s = number(),
                        .vz_mm_s = number(),
                        .residual_mm = particle.residual_mm,
                        .age_frames = static_cast<std::uint32_t>(i % 3)});
    if (!filtered) continue;
    TrackEstimate estimate{number(), number(), number(), {}, {}, {}};
    for (Covariance* c : {&estimate.position_mm2, &estimate.velocity_mm2_s2, &estimate.acceleration_mm2_s4})
      for (double& element : *c) element = number();
    result.tracks.estimate.push_back(estimate);
  }
}

}  // namespace rptv
