// SPDX-License-Identifier: MIT
// Follows rays from view to view, depth first, and lists the sets of detections that meet.
#include "reconstruct/correspondence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"

namespace rptv {

namespace {

constexpr double kSlack = 1.15;       // scales vary over the volume by less
constexpr double kMostAlong_px = 64;  // where two views hardly fix a depth

Point3 half_of(const Volume& volume) { return volume.to - volume.centre(); }

}  // namespace

/// Two detections: the ray of the first as all later views see it, and the depth on it that the second gives.
struct Correspondence::Seed {
  const std::array<EpipolarLine, kMaxViews>& lines;
  double t, depth_error_mm;
  double per_scale;  ///< of an error in the first view, mm/px
};

Correspondence::Correspondence(std::span<const ViewRays> views, const Volume& volume,
                               const CorrespondenceOptions& options, InstructionSet set)
    : options_(options), half_mm_(half_of(volume)), solver_({}, 1, set) {
  if (views.size() < 2 || views.size() > kMaxViews)
    throw Error(ExitCode::configuration,
                fmt::format("multi-view needs 2 to {} cameras and the rig has {}; correct the rig file", kMaxViews,
                            views.size()));
  if (options.min_views < 2 || options.min_views > views.size())
    throw Error(ExitCode::configuration,
                fmt::format("multi_view.min_views = {} and the rig has {} cameras; take 2 to {}", options.min_views,
                            views.size(), views.size()));
  const double scale_mm = TupleSolver::scale_mm(volume);
  for (const ViewRays& rays : views) views_.emplace_back(rays, options.max_detections, scale_mm);
  solver_ = TupleSolver(views_, scale_mm, set);
  matches_.reserve(options.max_matches);
  next_match_.resize(options.max_matches);
  doubtful_.reserve(2 * kDltLanes * kMaxViews);
  for (std::size_t v = 0; v < views.size(); ++v) first_match_[v].resize(options.max_detections);
}

std::span<const ViewMatch> Correspondence::match(std::span<const Detections> seen) noexcept {
  matches_.clear();
  solver_.clear();
  work_ = 0;
  counts_.pairs = counts_.tuples = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    counts_.unusable_detections += views_[v].look(seen[v]);
    std::fill_n(first_match_[v].begin(), views_[v].size(), kUnseen);
  }
  for (std::size_t v = 0; v + options_.min_views <= views_.size(); ++v)
    for (std::size_t i = 0; i < views_[v].size(); ++i) {
      if (work_ > kWorkPerMatch * options_.max_matches)
        ++counts_.unsearched;
      else if (views_[v].usable(i))
        follow(v, i);
    }
  solve(true);
  return matches_;
}

std::span<const ViewMatch> Correspondence::add(std::span<const ViewTuple> tuples) noexcept {
  const std::size_t before = matches_.size();
  for (const ViewTuple& tuple : tuples) propose(tuple);
  solve(true);
  return std::span<const ViewMatch>(matches_).subspan(before);
}

void Correspondence::follow(std::size_t view, std::size_t detection) noexcept {
  Sight sight;
  views_[view].sight(detection, sight.from_mm, sight.along);
  if (!clip(half_mm_, sight)) return;
  std::array<EpipolarLine, kMaxViews> lines;
  for (std::size_t v = view + 1; v < views_.size(); ++v) lines[v] = {views_[v].rays().pinhole(), sight};
  ViewTuple tuple = ViewTuple::none();
  tuple.put(view, static_cast<std::uint32_t>(detection));
  const double per_scale = kSlack / views_[view].rays().px_per_mm();
  for (std::size_t second = view + 1; second + options_.min_views <= views_.size() + 1; ++second) {
    const ViewRays& rays = views_[second].rays();
    const double reach_px = options_.tolerance_px * (1 + rays.px_per_mm() * per_scale) + rays.wander_px();
    visit_along(views_[second], lines[second], sight, reach_px, [&](std::uint32_t found, double t) {
      ++counts_.pairs;
      ++work_;
      const auto speed = lines[second].speed(t, lines[second].at(t));
      tuple.put(second, found);
      extend({lines, t, reach_px / std::hypot(speed[0], speed[1]), per_scale}, tuple, second + 1);
      tuple.put(second, kUnseen);
    });
  }
}

void Correspondence::extend(const Seed& seed, ViewTuple& tuple, std::size_t view) noexcept {
  const std::size_t start = view;
  for (; view < views_.size() && tuple.views + views_.size() - view >= options_.min_views; ++view) {
    std::array<std::uint32_t, kMostHits> hit;
    const std::size_t hits = ask(seed, view, hit);
    for (std::size_t h = 1; h < hits; ++h) {
      tuple.put(view, hit[h]);
      extend(seed, tuple, view + 1);
    }
    tuple.put(view, hits > 0 ? hit[0] : kUnseen);
  }
  if (tuple.views >= options_.min_views) propose(tuple);
  for (std::size_t v = start; v < views_.size(); ++v) tuple.put(v, kUnseen);
}

// The depth is as wrong as the first two views may be: the place is a box along this view's epipolar line.
std::size_t Correspondence::ask(const Seed& seed, std::size_t view,
                                std::array<std::uint32_t, kMostHits>& hit) noexcept {
  const ViewRays& rays = views_[view].rays();
  const auto at = seed.lines[view].at(seed.t), speed = seed.lines[view].speed(seed.t, at);
  const double fast = std::max(std::hypot(speed[0], speed[1]), 1e-9), u = speed[0] / fast, v = speed[1] / fast;
  const double across_px = options_.tolerance_px * (1 + rays.px_per_mm() * seed.per_scale) + rays.wander_px();
  const double along_px = std::min(across_px + fast * seed.depth_error_mm, kMostAlong_px);
  const double reach_u = std::abs(u) * along_px + std::abs(v) * across_px;
  const double reach_v = std::abs(v) * along_px + std::abs(u) * across_px;
  std::size_t hits = 0;
  views_[view].across_u().along(at[0] - reach_u, at[1], at[0] + reach_u, at[1], reach_v, [&](const auto& point) {
    ++work_;
    const double off_u = point.major - at[0], off_v = point.minor - at[1];
    const bool near = std::abs(off_u * v - off_v * u) <= across_px && std::abs(off_u * u + off_v * v) <= along_px;
    if (!near) return;
    if (hits < hit.size())
      hit[hits++] = point.number;
    else
      ++counts_.refused_hits;
  });
  return hits;
}

void Correspondence::propose(const ViewTuple& tuple) noexcept {
  solver_.push(tuple);
  if (solver_.full()) solve(false);
}

// A tuple that does not meet is tried without its worst view; and where one view less is the least there may be,
// without any one of its views.
void Correspondence::solve(bool all) noexcept {
  while (solver_.full() || (all && !solver_.empty())) {
    solver_.solve([this](const ViewMatch& found, std::size_t worst, double worst_px) {
      ++counts_.tuples;
      ++work_;
      if (worst_px <= options_.tolerance_px) return accept(found);
      if (found.tuple.views <= options_.min_views) return;
      for (std::size_t v = 0; v < views_.size(); ++v) {
        if (found.tuple.detection[v] == kUnseen) continue;
        if (v != worst && found.tuple.views > options_.min_views + 1) continue;
        doubtful_.push_back(found.tuple);
        doubtful_.back().put(v, kUnseen);
      }
    });
    for (; !doubtful_.empty() && !solver_.full(); doubtful_.pop_back()) solver_.push(doubtful_.back());
  }
}

void Correspondence::accept(const ViewMatch& match) noexcept {
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(match.at_mm[k]) > half_mm_[k]) return;
  if (listed(match.tuple)) return;
  if (matches_.size() == options_.max_matches) {
    ++counts_.refused_matches;
    return;
  }
  const auto number = static_cast<std::uint32_t>(matches_.size());
  matches_.push_back(match);
  for (std::size_t v = 0; v < views_.size(); ++v) {
    if (match.tuple.detection[v] == kUnseen) continue;
    next_match_[number][v] = std::exchange(first_match_[v][match.tuple.detection[v]], number);
  }
}

// Itself, or within a larger one.
bool Correspondence::listed(const ViewTuple& tuple) const noexcept {
  std::size_t first = 0;
  while (tuple.detection[first] == kUnseen) ++first;
  for (std::uint32_t m = first_match_[first][tuple.detection[first]]; m != kUnseen; m = next_match_[m][first]) {
    bool within = true;
    for (std::size_t v = first; v < views_.size(); ++v)
      within &= tuple.detection[v] == kUnseen || tuple.detection[v] == matches_[m].tuple.detection[v];
    if (within) return true;
  }
  return false;
}

}  // namespace rptv
