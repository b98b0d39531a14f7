// SPDX-License-Identifier: MIT
// Follows rays from view to view, depth first, and lists the sets of detections that meet.
#include "reconstruct/multi_view/correspondence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/error.hpp"
#include "reconstruct/multi_view/asked_place_kernel.hpp"

namespace rptv {

/// Two detections: the ray of the first, and the depth on it that the second gives.
struct Correspondence::Seed {
  Sight sight;
  double t, depth_error_mm;
  double px_per_mm;  ///< of the first view
};

Correspondence::Correspondence(std::span<const ViewRays> views, const Volume& volume,
                               const CorrespondenceOptions& options, InstructionSet set)
    : options_(options), half_mm_(volume.to - volume.centre()), pencil_(options.max_detections), solver_({}, 1, set) {
  if (views.size() < 2 || views.size() > kMaxViews)
    throw Error(ExitCode::configuration,
                fmt::format("multi-view needs 2 to {} cameras and the rig has {}; correct the rig file", kMaxViews,
                            views.size()));
  if (options.min_views < 2 || options.min_views > views.size())
    throw Error(ExitCode::configuration,
                fmt::format("multi_view.min_views = {} and the rig has {} cameras; take 2 to {}", options.min_views,
                            views.size(), views.size()));
  const double scale_mm = TupleSolver::scale_mm(volume);
  for (std::size_t w = 0; w < views.size(); ++w) {
    bool pencils = true;  // else strips are walked along epipolar lines, in either direction
    for (std::size_t v = 0; v < w; ++v) {
      lines_[v][w] = PencilOfLines(views[v], views[w]);
      pencils = pencils && lines_[v][w].usable;
    }
    views_.emplace_back(views[w], options.max_detections, scale_mm, !pencils);
  }
  solver_ = TupleSolver(views_, scale_mm, set);
  matches_.reserve(options.max_matches);
  next_match_.resize(options.max_matches);
  doubtful_.reserve(2 * kDltLanes * kMaxViews);
  for (std::size_t v = 0; v < views.size(); ++v) {
    first_match_[v].resize(options.max_detections);
    settled_[v].resize(options.max_detections);
  }
}

std::span<const ViewMatch> Correspondence::match(std::span<const Detections> seen) noexcept {
  matches_.clear();
  solver_.clear();
  work_ = 0;
  counts_.rays = counts_.pairs = counts_.tuples = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) {
    counts_.unusable_detections += views_[v].look(seen[v]);
    std::fill_n(settled_[v].begin(), views_[v].size(), std::uint8_t{0});
  }
  forget();
  std::size_t settled = 0;  // matches that settle() has seen
  for (std::size_t first = 0; first + options_.min_views <= views_.size(); ++first)
    for (std::size_t second = first + 1; second + options_.min_views <= views_.size() + 1; ++second) {
      if (lines_[first][second].usable) pencil_.build(lines_[first][second], views_[second]);
      for (std::size_t i = 0; i < views_[first].size(); ++i) {
        if (work_ > kWorkPerMatch * options_.max_matches)
          ++counts_.unsearched;
        else if (views_[first].usable(i) && settled_[first][i] == 0)
          follow(first, second, i);
      }
      solve(true);
      settle(std::exchange(settled, matches_.size()));
    }
  return matches_;
}

void Correspondence::forget() noexcept {
  for (std::size_t v = 0; v < views_.size(); ++v) std::fill_n(first_match_[v].begin(), views_[v].size(), kUnseen);
}

std::span<const ViewMatch> Correspondence::add(std::span<const ViewTuple> tuples) noexcept {
  const std::size_t before = matches_.size();
  forget();
  for (const ViewTuple& tuple : tuples) propose(tuple);
  solve(true);
  return std::span<const ViewMatch>(matches_).subspan(before);
}

void Correspondence::follow(std::size_t first, std::size_t second, std::size_t detection) noexcept {
  Seed seed;
  views_[first].sight(detection, seed.sight.from_mm, seed.sight.along);
  if (!clip(half_mm_, seed.sight)) return;
  ++counts_.rays;
  const ViewRays& rays = views_[second].rays();
  seed.px_per_mm = views_[first].rays().px_per_mm();
  const EpipolarLine line(rays.pinhole(), seed.sight);
  const double error_px = across_px(options_.tolerance_px, rays.px_per_mm(), seed.px_per_mm);
  const auto visit = [&](std::uint32_t found, double t) {
    ++counts_.pairs;
    ++work_;
    if (settled_[second][found] != 0) return;
    seed.t = t;
    if (rays.wander_px() > kNoWander_px && !meets(seed, second, found, error_px)) return;
    seed.depth_error_mm = depth_error_mm(error_px, line.place(seed.t));
    ViewTuple tuple = ViewTuple::none();
    tuple.put(first, static_cast<std::uint32_t>(detection));
    tuple.put(second, found);
    extend(seed, tuple, second + 1);
  };
  if (lines_[first][second].usable)
    pencil_.visit_near(line, seed.sight, error_px + rays.wander_px(), visit);
  else
    visit_along(views_[second], line, seed.sight, error_px + rays.wander_px(), visit);
}

// Where refraction makes rays wander in the pinhole image, they are asked themselves.
bool Correspondence::meets(Seed& seed, std::size_t view, std::uint32_t detection, double error_px) const noexcept {
  Point3 from_mm, along;
  views_[view].sight(detection, from_mm, along);
  seed.t = nearest_depth(seed.sight, from_mm, along);
  const auto miss =
      miss_px(views_[view].ray(detection), views_[view].rays().axes(), seed.sight.from_mm + seed.t * seed.sight.along);
  return miss[0] * miss[0] + miss[1] * miss[1] <= error_px * error_px;
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

std::size_t Correspondence::ask(const Seed& seed, std::size_t view,
                                std::array<std::uint32_t, kMostHits>& hit) noexcept {
  const ViewRays& rays = views_[view].rays();
  const EpipolarLine line(rays.pinhole(), seed.sight);
  const AskedPlace at(line.place(seed.t), options_.tolerance_px,
                      across_px(options_.tolerance_px, rays.px_per_mm(), seed.px_per_mm), seed.depth_error_mm);
  const bool wanders = rays.wander_px() > kNoWander_px;
  const double reach_u = at.reach_u() + rays.wander_px(), reach_v = at.reach_v() + rays.wander_px();
  const Point3 place = seed.sight.from_mm + seed.t * seed.sight.along;
  std::size_t hits = 0;
  views_[view].across_u().around(at.u, at.v, reach_u, reach_v, [&](const auto& point) {
    ++work_;
    if (settled_[view][point.number] != 0) return;
    std::array<double, 2> off{at.u - point.major, at.v - point.minor};
    if (wanders) off = miss_px(views_[view].ray(point.number), rays.axes(), place);
    if (!at.holds(off[0], off[1])) return;
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

void Correspondence::settle(std::size_t first_match) noexcept {
  const double square_px2 = options_.tolerance_px * options_.tolerance_px / 4;  // of a view, on average
  for (std::size_t m = first_match; m < matches_.size(); ++m) {
    const ViewMatch& match = matches_[m];
    if (match.tuple.views < std::min(views_.size(), kEnoughViews) || match.square_px2 > match.tuple.views * square_px2)
      continue;
    for (std::size_t v = 0; v < views_.size(); ++v)
      if (match.tuple.detection[v] != kUnseen) settled_[v][match.tuple.detection[v]] = 1;
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
