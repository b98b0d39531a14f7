// SPDX-License-Identifier: MIT
// The linker's memory and the steps of one frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tracking/cell_grid.hpp"
#include "tracking/deadline.hpp"
#include "tracking/frame_clock.hpp"
#include "tracking/linker.hpp"
#include "tracking/matching.hpp"
#include "tracking/motion.hpp"
#include "tracking/track_state.hpp"

namespace rptv {

class Linker::Work {
 public:
  explicit Work(const LinkerSettings& chosen);

  void forget_old(Tracks& out) noexcept;
  void expect() noexcept;
  void choose(const Particles& particles) noexcept;
  void carry_on(const Particles& particles) noexcept;
  void remember(Tracks& out) noexcept;
  void begin_tracks(const Particles& particles, std::size_t count) noexcept;
  void start_up() noexcept;
  void report(const Particles& particles, std::size_t count, Tracks& out) noexcept;
  void count(std::size_t offered, std::size_t taken, const LinkerCounters& before, Tracks& out) noexcept;

  const Seen& seen(std::size_t track) const noexcept {
    return track < seen_count ? last_seen : unseen[track - seen_count];
  }

  LinkerSettings settings;
  std::size_t max_tracks, max_particles;
  SearchRange range;
  FrameClock clock;
  FrameTime now;
  std::int64_t exposure_ns = 0;  // of the last frame, on the camera's clock
  Deadline deadline;
  Motion motion;
  CellGrid grid;
  std::vector<Spot> expected;
  Matching matching;
  std::vector<std::uint8_t> owned;  // per place in the grid: a track goes on there
  // Seen tracks in grid order, then the unseen ones, last seen first. Swapped every frame.
  std::vector<TrackState> tracks, next_tracks;
  Seen last_seen;                         // of the first seen_count tracks
  std::vector<Seen> unseen, next_unseen;  // of the others
  std::size_t seen_count = 0, live = 0, next_live = 0;
  std::vector<std::uint32_t> newborn;  // places
  std::size_t newborn_count = 0;
  std::vector<std::uint32_t> track_of_row;
  std::uint64_t next_id = 0;
  LinkerCounters counters;
};

}  // namespace rptv
