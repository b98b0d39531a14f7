// SPDX-License-Identifier: MIT
// One frame of linking, in the order of its steps: time, expectation, candidates, assignment, bookkeeping.
#include "tracking/linker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "tracking/linker_work.hpp"
#include "tracking/nearest.hpp"

namespace rptv {

namespace {

constexpr std::size_t kAhead = 16;  // tracks: they go to another order, and fetching one takes as long as moving many

LinkerSettings checked(LinkerSettings settings) {
  settings.check();
  settings.max_tracks = std::max(settings.max_tracks, settings.max_particles);
  return settings;
}

}  // namespace

Linker::Work::Work(const LinkerSettings& chosen)
    : settings(checked(chosen)),
      max_tracks(static_cast<std::size_t>(settings.max_tracks)),
      max_particles(static_cast<std::size_t>(settings.max_particles)),
      range(settings.range_mm()),
      motion(settings, max_tracks),
      grid(max_particles),
      expected(max_tracks),
      matching(settings, max_tracks, max_particles),
      owned(max_particles),
      tracks(max_tracks),
      next_tracks(max_tracks),
      unseen(max_tracks),
      next_unseen(max_tracks),
      newborn(max_particles),
      track_of_row(settings.filters() ? max_particles : 0) {}

Linker::Linker(const LinkerSettings& settings) : work_(std::make_unique<Work>(settings)) {}
Linker::~Linker() = default;
Linker::Linker(Linker&&) noexcept = default;
Linker& Linker::operator=(Linker&&) noexcept = default;

const LinkerCounters& Linker::counters() const noexcept { return work_->counters; }
std::size_t Linker::live_tracks() const noexcept { return work_->live; }
std::size_t Linker::capacity() const noexcept { return work_->max_tracks; }

void Linker::seed(std::span<const VelocitySample> samples) {
  for (const VelocitySample& s : samples)
    if (!std::isfinite(s.x_mm + s.y_mm + s.z_mm + s.vx_mm_s + s.vy_mm_s + s.vz_mm_s))
      throw Error(ExitCode::configuration, "a velocity to start with is not finite; leave it out");
  work_->motion.seed(samples);
}

void Linker::next(const Particles& particles, std::uint64_t frame, std::int64_t exposure_end_ns, Tracks& out) noexcept {
  Work& work = *work_;
  const LinkerCounters before = work.counters;
  out.clear_events();
  work.deadline.start(static_cast<std::int64_t>(work.settings.deadline_ms * 1e6));
  work.now = work.clock.advance(frame, exposure_end_ns);
  work.exposure_ns = exposure_end_ns;
  work.motion.begin_frame(work.now, work.clock.period_ns());
  work.forget_old(out);
  const std::size_t count = std::min(particles.size(), work.max_particles);
  work.grid.build(particles.x_mm.data(), particles.y_mm.data(), particles.z_mm.data(), count, work.range);
  work.expect();
  work.choose(particles);
  work.carry_on(particles);
  work.remember(out);
  work.begin_tracks(particles, count);
  std::swap(work.tracks, work.next_tracks);
  std::swap(work.unseen, work.next_unseen);
  work.live = work.next_live;
  work.seen_count = work.grid.size();
  work.last_seen = {work.now.ns, work.now.frame, work.now.epoch};
  work.start_up();
  work.report(particles, count, out);
  work.count(particles.size(), count, before, out);
}

/// A gap in the frame indices may have outlasted memories before this frame's particles are even looked at.
void Linker::Work::forget_old(Tracks& out) noexcept {
  if (now.frames_since_last <= 1) return;
  const auto longest = static_cast<std::uint64_t>(settings.memory) + 1;
  std::size_t kept = 0;
  std::size_t kept_seen = 0;
  for (std::size_t s = 0; s < live; ++s) {
    const Seen when = seen(s);
    if (now.frame - when.frame > longest) {
      ++counters.deaths;
      out.push_death(tracks[s].id);
      motion.end(tracks[s]);
      continue;
    }
    tracks[kept] = tracks[s];
    if (s < seen_count)
      ++kept_seen;
    else
      unseen[kept - kept_seen] = when;
    ++kept;
  }
  seen_count = kept_seen;
  live = kept;
}

void Linker::Work::expect() noexcept {
  motion.expect({tracks.data(), seen_count}, last_seen.ns, expected.data());
  for (std::size_t s = seen_count; s < live; ++s)
    motion.expect({&tracks[s], 1}, unseen[s - seen_count].ns, &expected[s]);
}

void Linker::Work::choose(const Particles& particles) noexcept {
  if (motion.gated()) motion.gate_by(grid, particles, {tracks.data(), live});
  matching.match(grid, {expected.data(), live}, motion.gated() ? &motion : nullptr, deadline, counters);
}

void Linker::Work::carry_on(const Particles& particles) noexcept {
  std::fill_n(owned.begin(), grid.size(), std::uint8_t{0});
  std::uint64_t links = 0;
  for (std::size_t s = 0; s < live; ++s) {
    const std::uint32_t place = matching.target_of(s);
    if (s + kAhead < live) {
      const std::size_t ahead = std::min<std::size_t>(matching.target_of(s + kAhead), max_tracks - 1);
      __builtin_prefetch(&next_tracks[ahead], 1);
    }
    if (place == Matching::kNone) continue;
    owned[place] = 1;
    ++links;
    TrackState& track = next_tracks[place];
    track = tracks[s];
    const Seen& when = seen(s);
    const bool timed = when.clock_epoch == now.epoch && now.ns > when.ns;
    const Spot at{grid.x(place), grid.y(place), grid.z(place)};
    if (motion.filters())
      motion.filter_on(track, timed, at, particles.covariance_mm2[grid.original(place)]);
    else
      motion.move_on(track, when.ns, timed, at);
  }
  counters.links += links;
}

/// Unlinked tracks stay behind the seen ones, last seen first, as long as memory and room last.
void Linker::Work::remember(Tracks& out) noexcept {
  next_live = grid.size();
  for (std::size_t s = 0; s < live; ++s) {
    if (matching.target_of(s) != Matching::kNone) continue;
    const Seen& when = seen(s);
    const bool can_return = now.frame - when.frame <= static_cast<std::uint64_t>(settings.memory);
    if (can_return && next_live < max_tracks) {
      next_unseen[next_live - grid.size()] = when;
      next_tracks[next_live++] = tracks[s];
      continue;
    }
    if (can_return) ++counters.forgotten_tracks;
    ++counters.deaths;
    out.push_death(tracks[s].id);
    motion.end(tracks[s]);
  }
}

/// In the order of the input, so that identities count up along the output.
void Linker::Work::begin_tracks(const Particles& particles, std::size_t count) noexcept {
  const std::uint64_t first_id = next_id;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t place = grid.place(i);
    if (place == CellGrid::kNone || owned[place] != 0) continue;
    TrackState& track = next_tracks[place];
    track = TrackState{};
    track.x_mm = grid.x(place);
    track.y_mm = grid.y(place);
    track.z_mm = grid.z(place);
    newborn[next_id - first_id] = place;
    track.id = next_id++;
    motion.begin(track, particles.covariance_mm2[i]);
  }
  newborn_count = next_id - first_id;
  counters.births += newborn_count;
}

/// A new track is expected to move like the nearest one whose velocity is known, as trackpy's NearestVelocityPredict.
void Linker::Work::start_up() noexcept {
  if (!motion.starts_like_neighbours()) return;
  const bool velocities_known = newborn_count < seen_count && counters.frames > 0;
  for (std::size_t i = 0; i < newborn_count; ++i) {
    TrackState& track = tracks[newborn[i]];
    VelocitySample like{track.x_mm, track.y_mm, track.z_mm};
    std::uint32_t place = CellGrid::kNone;
    if (velocities_known)
      place = grid.find_nearest(track.x_mm, track.y_mm, track.z_mm,
                                [&](std::uint32_t other) noexcept { return tracks[other].age_frames > 0; });
    if (place != CellGrid::kNone) {
      like.vx_mm_s = tracks[place].vx_mm_s;
      like.vy_mm_s = tracks[place].vy_mm_s;
      like.vz_mm_s = tracks[place].vz_mm_s;
    } else if (!motion.nearest_seed(like)) {
      continue;
    }
    motion.set_expected_velocity(track, like);
  }
}

}  // namespace rptv
