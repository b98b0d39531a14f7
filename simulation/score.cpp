// SPDX-License-Identifier: MIT
// One-to-one pairing frame by frame, then sums over frames and along trajectories.
#include "simulation/score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <unordered_map>

#include "core/error.hpp"

namespace rptv {

namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);
using Indices = std::vector<std::size_t>;

template <class Row>
std::map<std::uint64_t, Indices> by_frame(const std::vector<Row>& rows) {
  std::map<std::uint64_t, Indices> frames;
  for (std::size_t i = 0; i < rows.size(); ++i) frames[rows[i].frame].push_back(i);
  return frames;
}

std::array<double, 3> position_of(const TrackRow& row) { return {row.x_mm, row.y_mm, row.z_mm}; }
std::array<double, 3> velocity_of(const TrackRow& row) { return {row.vx_mm_s, row.vy_mm_s, row.vz_mm_s}; }

struct Pair {
  double distance2;
  std::size_t measured, truth;
  bool operator<(const Pair& other) const {
    return std::tie(distance2, measured, truth) < std::tie(other.distance2, other.measured, other.truth);
  }
};

/// All pairs inside the box of one frame; `truth` sorted along x.
std::vector<Pair> near_pairs(const std::vector<TrackRow>& measured, const Indices& found,
                             const std::vector<TruthRow>& truth, const Indices& real,
                             const std::array<double, 3>& radius) {
  std::vector<Pair> pairs;
  for (const std::size_t m : found) {
    const auto at = position_of(measured[m]);
    auto begin = std::lower_bound(real.begin(), real.end(), at[0] - radius[0],
                                  [&](std::size_t t, double x) { return truth[t].x_mm < x; });
    for (; begin != real.end() && truth[*begin].x_mm <= at[0] + radius[0]; ++begin) {
      const auto to = position_of(truth[*begin]);
      double distance2 = 0;
      bool inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double d = (at[axis] - to[axis]) / radius[axis];
        inside = inside && std::abs(d) <= 1;
        distance2 += d * d;
      }
      if (inside) pairs.push_back({distance2, m, *begin});
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

class ErrorSum {
 public:
  void add(const std::array<double, 3>& measured, const std::array<double, 3>& truth) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double error = measured[axis] - truth[axis];
      sum_[axis] += error;
      absolute_[axis] += std::abs(error);
      square_[axis] += error * error;
    }
    ++count_;
  }
  AxisErrors result() const {
    AxisErrors errors;
    if (count_ == 0) return errors;
    const auto n = static_cast<double>(count_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      errors.mean[axis] = sum_[axis] / n;
      errors.mean_absolute[axis] = absolute_[axis] / n;
      errors.rms[axis] = std::sqrt(square_[axis] / n);
    }
    return errors;
  }

 private:
  std::array<double, 3> sum_{}, absolute_{}, square_{};
  std::uint64_t count_ = 0;
};

double share(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// Partner of each measured row and of each true row, or kNone.
struct Matches {
  Indices of_measured, of_truth;
  std::uint64_t first_frame = 0, last_frame = 0;
};

Matches match(const Measurement& measured, const std::vector<TruthRow>& truth, const ScoreSettings& settings) {
  const auto found = by_frame(measured.rows);
  auto real = by_frame(truth);
  Matches matches{Indices(measured.rows.size(), kNone), Indices(truth.size(), kNone)};
  if (found.empty()) {  // nothing measured: the whole truth was missed
    matches.last_frame = std::numeric_limits<std::uint64_t>::max();
    return matches;
  }
  matches.first_frame = found.begin()->first;
  matches.last_frame = found.rbegin()->first;
  bool common = false;
  for (const auto& [frame, rows] : found) {
    const auto at = real.find(frame);
    if (at == real.end()) continue;
    common = true;
    std::sort(at->second.begin(), at->second.end(), [&](auto a, auto b) { return truth[a].x_mm < truth[b].x_mm; });
    for (const auto& pair : near_pairs(measured.rows, rows, truth, at->second, settings.radius_mm))
      if (matches.of_measured[pair.measured] == kNone && matches.of_truth[pair.truth] == kNone) {
        matches.of_measured[pair.measured] = pair.truth;
        matches.of_truth[pair.truth] = pair.measured;
      }
  }
  if (!common)
    throw Error(ExitCode::bad_data, "no measured frame is in the truth (measured frames " +
                                        std::to_string(matches.first_frame) + " to " +
                                        std::to_string(matches.last_frame) + "); give the truth of the same recording");
  return matches;
}

DetectionScore score_detection(const Measurement& measured, const std::vector<TruthRow>& truth,
                               const Matches& matches) {
  DetectionScore result;
  std::set<std::uint64_t> frames;
  ErrorSum errors;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    const auto& row = truth[t];
    if (row.frame < matches.first_frame || row.frame > matches.last_frame) continue;
    frames.insert(row.frame);
    const std::size_t m = matches.of_truth[t];
    if (!row.in_view) {
      result.partly_visible += m != kNone;
      continue;
    }
    ++result.truth;
    if (m == kNone) continue;
    ++result.found;
    errors.add(position_of(measured.rows[m]), position_of(row));
  }
  result.frames = frames.size();
  result.measured = measured.rows.size();
  result.ghosts = result.measured - result.found - result.partly_visible;
  result.recall = share(result.found, result.truth);
  result.precision = share(result.measured - result.ghosts, result.measured);
  result.position_mm = errors.result();
  const auto& rms = result.position_mm.rms;
  result.rms_mm = std::hypot(rms[0], rms[1], rms[2]);
  return result;
}

/// Unbroken runs of frames in view, as rows of the truth in order of time.
std::vector<Indices> trajectories_of(const std::vector<TruthRow>& truth, const Matches& matches) {
  Indices order;
  for (std::size_t t = 0; t < truth.size(); ++t)
    if (truth[t].in_view && truth[t].frame >= matches.first_frame && truth[t].frame <= matches.last_frame)
      order.push_back(t);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) {
    return std::tie(truth[a].particle, truth[a].frame) < std::tie(truth[b].particle, truth[b].frame);
  });
  std::vector<Indices> runs;
  for (const std::size_t t : order) {
    const bool continues = !runs.empty() && truth[runs.back().back()].particle == truth[t].particle &&
                           truth[runs.back().back()].frame + 1 == truth[t].frame;
    if (!continues) runs.emplace_back();
    runs.back().push_back(t);
  }
  return runs;
}

void score_trajectories(const Measurement& measured, const std::vector<Indices>& runs, const Matches& matches,
                        TrackScore& result) {
  double coverage = 0;
  std::uint64_t pieces = 0;
  for (const auto& run : runs) {
    std::map<std::uint64_t, std::uint64_t> frames_of_track;
    std::uint64_t last = 0;
    bool seen = false;
    for (const std::size_t t : run) {
      if (matches.of_truth[t] == kNone) continue;
      const std::uint64_t track = measured.rows[matches.of_truth[t]].particle;
      if (seen && track != last) ++result.id_switches;
      last = track;
      seen = true;
      ++frames_of_track[track];
    }
    std::uint64_t longest = 0;
    for (const auto& [track, frames] : frames_of_track) longest = std::max(longest, frames);
    coverage += share(longest, run.size());
    pieces += frames_of_track.size();
    result.trajectories_found += seen;
  }
  result.trajectories = runs.size();
  result.coverage = runs.empty() ? 0 : coverage / static_cast<double>(runs.size());
  result.fragmentation = share(pieces, result.trajectories_found);
}

TrackScore score_tracks(const Measurement& measured, const std::vector<TruthRow>& truth, const Matches& matches) {
  TrackScore result;
  std::unordered_map<std::uint64_t, std::map<std::uint64_t, std::uint64_t>> partners;  // track → true particle → points
  ErrorSum errors;
  for (std::size_t m = 0; m < measured.rows.size(); ++m) {
    const auto& row = measured.rows[m];
    auto& particles = partners[row.particle];
    const std::size_t t = matches.of_measured[m];
    if (t == kNone) continue;
    ++particles[truth[t].particle];
    if (row.age > 0 && truth[t].in_view) errors.add(velocity_of(row), velocity_of(truth[t]));
  }
  std::uint64_t paired = 0, pure = 0;
  for (const auto& [track, particles] : partners) {
    std::uint64_t most = 0;
    for (const auto& [particle, points] : particles) {
      paired += points;
      most = std::max(most, points);
    }
    pure += most;
    result.ghost_tracks += particles.empty();
  }
  result.tracks = partners.size();
  result.purity = share(pure, paired);
  result.velocity_mm_s = errors.result();
  score_trajectories(measured, trajectories_of(truth, matches), matches, result);
  return result;
}

}  // namespace

Score score(const Measurement& measured, const std::vector<TruthRow>& truth, const ScoreSettings& settings) {
  const Matches matches = match(measured, truth, settings);
  Score result;
  result.detection = score_detection(measured, truth, matches);
  result.linked = measured.linked;
  if (measured.linked) result.track = score_tracks(measured, truth, matches);
  return result;
}

}  // namespace rptv
