// SPDX-License-Identifier: MIT
// One frame of linking, in the order of its steps: time, expectation, candidates, subnetworks, assignment, bookkeeping.
#include "tracking/linker.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "tracking/assignment.hpp"
#include "tracking/candidates.hpp"
#include "tracking/cell_grid.hpp"
#include "tracking/frame_clock.hpp"
#include "tracking/predictor.hpp"
#include "tracking/subnet.hpp"
#include "tracking/track_state.hpp"

namespace rptv {

namespace {

LinkerSettings checked(LinkerSettings settings) {
  if (!(settings.search_range_mm >= 1e-9 && settings.search_range_mm <= 1e9))
    throw Error(ExitCode::configuration,
                "search_range_mm is " + std::to_string(settings.search_range_mm) + "; give a length of 1e-9 to 1e9 mm");
  if (settings.memory < 0 || settings.max_particles < 1 || settings.max_candidates < 1)
    throw Error(ExitCode::configuration, "memory " + std::to_string(settings.memory) + ", max_particles " +
                                             std::to_string(settings.max_particles) + ", max_candidates " +
                                             std::to_string(settings.max_candidates) +
                                             ": memory must be 0 or more, the others 1 or more");
  settings.max_tracks = std::max(settings.max_tracks, settings.max_particles);
  return settings;
}

}  // namespace

class Linker::Work {
 public:
  explicit Work(const LinkerSettings& chosen)
      : settings(checked(chosen)),
        max_tracks(static_cast<std::size_t>(settings.max_tracks)),
        max_particles(static_cast<std::size_t>(settings.max_particles)),
        predictor(settings.predict),
        grid(max_particles),
        expected(max_tracks),
        candidates(max_tracks, max_particles, static_cast<std::size_t>(settings.max_candidates)),
        subnets(max_tracks, max_particles),
        assignment(max_tracks, max_particles),
        contested(max_tracks),
        owned(max_particles),
        tracks(max_tracks),
        next_tracks(max_tracks) {}

  void forget_old(const FrameTime& now, Tracks& out) noexcept;
  void choose() noexcept;
  void carry_on(const FrameTime& now) noexcept;
  void remember(const FrameTime& now, Tracks& out) noexcept;
  void begin_tracks(const FrameTime& now, std::size_t particles) noexcept;
  void report(const Particles& particles, std::size_t count, Tracks& out) const noexcept;
  void count(std::size_t offered, std::size_t taken) noexcept;

  LinkerSettings settings;
  std::size_t max_tracks, max_particles;
  FrameClock clock;
  Predictor predictor;
  CellGrid grid;
  Positions expected;
  Candidates candidates;
  Subnets subnets;
  Assignment assignment;
  std::vector<std::uint32_t> contested;  // tracks whose choice depends on others
  std::vector<std::uint8_t> owned;       // per place in the grid: a track goes on there
  // Seen tracks in grid order, then the remembered ones, last seen first. Swapped every frame.
  std::vector<TrackState> tracks, next_tracks;
  std::size_t live = 0, next_live = 0;
  std::uint64_t next_id = 0;
  LinkerCounters counters;
};

Linker::Linker(const LinkerSettings& settings) : work_(std::make_unique<Work>(settings)) {}
Linker::~Linker() = default;
Linker::Linker(Linker&&) noexcept = default;
Linker& Linker::operator=(Linker&&) noexcept = default;

const LinkerCounters& Linker::counters() const noexcept { return work_->counters; }
std::size_t Linker::live_tracks() const noexcept { return work_->live; }
std::size_t Linker::capacity() const noexcept { return work_->max_tracks; }

void Linker::next(const Particles& particles, std::uint64_t frame, std::int64_t exposure_end_ns, Tracks& out) noexcept {
  Work& work = *work_;
  out.clear();
  const FrameTime now = work.clock.advance(frame, exposure_end_ns);
  work.forget_old(now, out);
  const std::size_t count = std::min(particles.size(), work.max_particles);
  work.grid.build(particles.x_mm.data(), particles.y_mm.data(), particles.z_mm.data(), count,
                  work.settings.search_range_mm);
  work.predictor.predict({work.tracks.data(), work.live}, now, work.expected);
  work.candidates.find(work.grid, work.expected, work.live);
  work.choose();
  work.carry_on(now);
  work.begin_tracks(now, count);
  work.remember(now, out);
  std::swap(work.tracks, work.next_tracks);
  work.live = work.next_live;
  work.report(particles, count, out);
  work.count(particles.size(), count);
}

/// A gap in the frame indices may have outlasted memories before this frame's particles are even looked at.
void Linker::Work::forget_old(const FrameTime& now, Tracks& out) noexcept {
  if (now.frames_since_last <= 1) return;
  const auto longest = static_cast<std::uint64_t>(settings.memory) + 1;
  const auto first = tracks.begin();
  const auto end =
      std::remove_if(first, first + static_cast<std::ptrdiff_t>(live), [&](const TrackState& track) noexcept {
        if (now.frame - track.seen_frame <= longest) return false;
        ++counters.deaths;
        out.push_death(track.id);
        return true;
      });
  live = static_cast<std::size_t>(end - first);
}

/// Links what nobody disputes and hands the rest to the assignment, one subnetwork at a time.
void Linker::Work::choose() noexcept {
  std::size_t disputed = 0;
  for (std::uint32_t s = 0; s < live; ++s) {
    const auto row = candidates.of(s);
    if (row.empty())
      assignment.settle(s, Assignment::kNone);
    else if (candidates.demand(row.front().place) == 1)
      assignment.settle(s, row.front().place);  // its nearest particle, and no other track can want it
    else
      contested[disputed++] = s;
  }
  subnets.split(candidates, {contested.data(), disputed});
  for (std::size_t net = 0; net < subnets.size(); ++net) {
    assignment.solve(candidates, subnets[net]);
    counters.largest_subnet = std::max<std::uint64_t>(counters.largest_subnet, subnets[net].size());
  }
  counters.subnets += subnets.size();
}

void Linker::Work::carry_on(const FrameTime& now) noexcept {
  std::fill_n(owned.begin(), grid.size(), std::uint8_t{0});
  for (std::size_t s = 0; s < live; ++s) {
    const std::uint32_t place = assignment.target_of(s);
    if (place == Assignment::kNone) continue;
    owned[place] = 1;
    next_tracks[place] = tracks[s];
    Predictor::update(next_tracks[place], now, grid.x(place), grid.y(place), grid.z(place));
    ++counters.links;
  }
}

/// In the order of the input, so that identities count up along the output.
void Linker::Work::begin_tracks(const FrameTime& now, std::size_t particles) noexcept {
  for (std::size_t i = 0; i < particles; ++i) {
    const std::uint32_t place = grid.place(i);
    if (place == CellGrid::kNone || owned[place] != 0) continue;
    TrackState track;
    track.x_mm = grid.x(place);
    track.y_mm = grid.y(place);
    track.z_mm = grid.z(place);
    track.id = next_id++;
    track.seen_ns = now.ns;
    track.seen_frame = now.frame;
    track.clock_epoch = now.epoch;
    next_tracks[place] = track;
    ++counters.births;
  }
}

/// Unlinked tracks stay behind the seen ones, last seen first, as long as memory and room last.
void Linker::Work::remember(const FrameTime& now, Tracks& out) noexcept {
  next_live = grid.size();
  for (std::size_t s = 0; s < live; ++s) {
    if (assignment.target_of(s) != Assignment::kNone) continue;
    const bool can_return = now.frame - tracks[s].seen_frame <= static_cast<std::uint64_t>(settings.memory);
    if (can_return && next_live < max_tracks) {
      next_tracks[next_live++] = tracks[s];
      continue;
    }
    if (can_return) ++counters.forgotten_tracks;
    ++counters.deaths;
    out.push_death(tracks[s].id);
  }
}

/// Whole columns at once, as push() row by row would cost as much as the search; rows beyond the capacity go through
/// push(), which counts them.
void Linker::Work::report(const Particles& particles, std::size_t count, Tracks& out) const noexcept {
  const std::size_t rows = std::min(grid.size(), out.capacity());
  out.particle.resize(rows);
  out.age_frames.resize(rows);
  for (auto* column : {&out.x_mm, &out.y_mm, &out.z_mm, &out.vx_mm_s, &out.vy_mm_s, &out.vz_mm_s, &out.residual_mm})
    column->resize(rows);
  std::size_t row = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (grid.place(i) == CellGrid::kNone) continue;
    const TrackState& t = tracks[grid.place(i)];
    if (row == rows) {
      out.push({t.id, t.x_mm, t.y_mm, t.z_mm, t.vx_mm_s, t.vy_mm_s, t.vz_mm_s, particles.residual_mm[i], t.age_frames});
      continue;
    }
    out.particle[row] = t.id;
    out.x_mm[row] = particles.x_mm[i];
    out.y_mm[row] = particles.y_mm[i];
    out.z_mm[row] = particles.z_mm[i];
    out.vx_mm_s[row] = t.vx_mm_s;
    out.vy_mm_s[row] = t.vy_mm_s;
    out.vz_mm_s[row] = t.vz_mm_s;
    out.residual_mm[row] = particles.residual_mm[i];
    out.age_frames[row] = t.age_frames;
    if (t.age_frames == 0) out.births.push_back(t.id);
    ++row;
  }
}

void Linker::Work::count(std::size_t offered, std::size_t taken) noexcept {
  ++counters.frames;
  counters.refused_particles += offered - taken;
  counters.ignored_particles += taken - grid.size();
  counters.truncated_searches = candidates.truncated();
  counters.clock_faults = clock.clock_faults();
  counters.frame_faults = clock.frame_faults();
}

}  // namespace rptv
