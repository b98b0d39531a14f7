// SPDX-License-Identifier: MIT
// What the pipeline knows about one instant: its time, its particles, its tracks, and when each stage was done.
#pragma once

#include <cstdint>

#include "core/clock.hpp"
#include "core/latency.hpp"
#include "core/object_pool.hpp"
#include "core/particles.hpp"
#include "core/tracks.hpp"

namespace rptv {

/// Filled by reconstruction, then the linker, then read by publisher and writers through leases.
struct Result {
  Result(std::size_t particle_capacity, std::size_t track_capacity)
      : particles(particle_capacity), tracks(track_capacity) {}

  std::uint64_t frame = 0;
  std::int64_t exposure_end_ns = 0;
  ClockId clock = ClockId::nominal;
  Stamps stamps;
  Particles particles;
  Tracks tracks;
};

using ResultPool = ObjectPool<Result>;
using ResultLease = Lease<ResultPool>;

}  // namespace rptv
