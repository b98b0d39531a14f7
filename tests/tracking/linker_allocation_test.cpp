// SPDX-License-Identifier: MIT
// The linker takes its memory when it is made and none after, whatever the frames are like.
#include <gtest/gtest.h>

#include <limits>

#include "tests/core/allocation_counter.hpp"
#include "tests/tracking/linking.hpp"
#include "tests/tracking/moving_points.hpp"

namespace rptv {
namespace {

class LinkerAllocation : public testing::TestWithParam<const char*> {};

TEST_P(LinkerAllocation, is_none_after_construction) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer has replaced malloc";
  constexpr std::size_t kCount = 3000;
  MovingPoints points(kCount, MovingPoints::Steps::gauss, 0.5, 2);
  Particles particles(kCount);
  LinkerSettings settings = settings_for(1.0, 3, GetParam());
  settings.gate_sigma = settings.filters() ? 5 : 0;
  settings.adaptive_stop_mm = 0.3;
  settings.max_subnet = 20;
  settings.deadline_ms = 20;
  settings.max_particles = settings.max_tracks = kCount;
  Session session(settings);
  Tracks later(session.linker.capacity());
  std::uint64_t allocations = 0;
  for (std::uint64_t frame = 0; frame < 12; ++frame) {
    points.next(particles);
    particles.x_mm[frame] = std::numeric_limits<double>::quiet_NaN();
    if (frame == 5) particles.x_mm[100] = 1e9;                   // an outlier: cells are hashed
    const std::uint64_t index = frame < 8 ? frame : 10 * frame;  // and gaps that outlast the memory
    AllocationCounter counter;
    session.linker.next(particles, index, static_cast<std::int64_t>(index) * kPeriodNs, session.tracks);
    session.linker.predict(static_cast<std::int64_t>(index + 2) * kPeriodNs, later);
    allocations += counter.disarm();
  }
  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(later.size(), session.linker.live_tracks());
  EXPECT_GT(session.linker.counters().subnets, 0U);
  EXPECT_GT(session.linker.counters().adapted_subnets, 0U);
  EXPECT_GT(session.linker.counters().deaths, kCount);
}

INSTANTIATE_TEST_SUITE_P(, LinkerAllocation,
                         testing::Values("none", "velocity", "flow", "kalman", "kalman_acceleration"));

}  // namespace
}  // namespace rptv
