// SPDX-License-Identifier: MIT
// What the linker says: the rows of a frame, its filters, and where tracks will be.
#include <algorithm>

#include "tracking/linker_work.hpp"
#include "tracking/track_estimate.hpp"

namespace rptv {

namespace {
constexpr std::size_t kRowsAhead =
    16;  // rows: tracks lie in another order, and one takes as long to come as many to write
}

/// Whole columns at once, as push() row by row would cost as much as the search; rows beyond the capacity go through
/// push(), which counts them.
void Linker::Work::report(const Particles& particles, std::size_t count, Tracks& out) noexcept {
  const std::size_t rows = std::min(grid.size(), out.capacity());
  out.particle.resize(rows);
  out.age_frames.resize(rows);
  for (auto* column : {&out.x_mm, &out.y_mm, &out.z_mm, &out.vx_mm_s, &out.vy_mm_s, &out.vz_mm_s, &out.residual_mm})
    column->resize(rows);
  out.estimate.resize(motion.filters() ? rows : 0);
  std::size_t row = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t place = grid.place(i);
    if (i + kRowsAhead < count)
      __builtin_prefetch(&tracks[std::min<std::size_t>(grid.place(i + kRowsAhead), max_tracks - 1)]);
    if (place == CellGrid::kNone) continue;
    const TrackState& t = tracks[place];
    const bool moved = t.age_frames > 0;
    if (row == rows) {
      out.push({t.id, t.x_mm, t.y_mm, t.z_mm, 0, 0, 0, particles.residual_mm[i], t.age_frames});
      continue;
    }
    out.particle[row] = t.id;
    out.x_mm[row] = t.x_mm;
    out.y_mm[row] = t.y_mm;
    out.z_mm[row] = t.z_mm;
    out.vx_mm_s[row] = moved ? t.vx_mm_s : 0;
    out.vy_mm_s[row] = moved ? t.vy_mm_s : 0;
    out.vz_mm_s[row] = moved ? t.vz_mm_s : 0;
    out.residual_mm[row] = particles.residual_mm[i];
    out.age_frames[row] = t.age_frames;
    if (!moved) out.births.push_back(t.id);
    if (motion.filters()) {
      out.estimate[row] = estimate_of(motion.filter(t));
      track_of_row[row] = place;
    }
    ++row;
  }
}

void Linker::Work::count(std::size_t offered, std::size_t taken, const LinkerCounters& before, Tracks& out) noexcept {
  out.adapted_subnets = static_cast<std::uint32_t>(counters.adapted_subnets - before.adapted_subnets);
  out.cut_subnets = static_cast<std::uint32_t>(counters.cut_subnets - before.cut_subnets);
  ++counters.frames;
  counters.refused_particles += offered - taken;
  counters.ignored_particles += taken - grid.size();
  counters.clock_faults = clock.clock_faults();
  counters.frame_faults = clock.frame_faults();
}

const KalmanModel& Linker::model() const noexcept { return work_->motion.model(); }

const KalmanState* Linker::filter_of(std::size_t row) const noexcept {
  const Work& work = *work_;
  if (!work.motion.filters() || row >= work.seen_count) return nullptr;
  return &work.motion.filter(work.tracks[work.track_of_row[row]]);
}

void Linker::predict(std::int64_t exposure_ns, Tracks& out) const noexcept {
  const Work& work = *work_;
  out.clear();
  std::int64_t ahead_ns = 0;
  if (__builtin_sub_overflow(exposure_ns, work.exposure_ns, &ahead_ns)) ahead_ns = 0;
  std::int64_t at_ns = 0;
  if (__builtin_add_overflow(work.now.ns, ahead_ns, &at_ns)) at_ns = work.now.ns;
  for (std::size_t s = 0; s < work.live; ++s) {
    const TrackState& t = work.tracks[s];
    KalmanState later;
    const Spot at = work.motion.extrapolate(t, work.seen(s).ns, at_ns, &later);
    TrackPoint point{t.id, at.x_mm, at.y_mm, at.z_mm, t.vx_mm_s, t.vy_mm_s, t.vz_mm_s, 0, t.age_frames};
    if (work.motion.filters()) {
      point.vx_mm_s = later.x[1][0];
      point.vy_mm_s = later.x[1][1];
      point.vz_mm_s = later.x[1][2];
    }
    if (out.push(point) && work.motion.filters()) out.estimate.push_back(estimate_of(later));
  }
  out.births.clear();
}

}  // namespace rptv
