// SPDX-License-Identifier: MIT
// Pairs of views in turn: their rays followed, what they found listed once, good sets settled.
#include "reconstruct/multi_view/correspondence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/error.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

Correspondence::Correspondence(std::span<const ViewRays> views, const Volume& volume,
                               const CorrespondenceOptions& options, InstructionSet set)
    : options_(options),
      half_mm_(volume.to - volume.centre()),
      pencil_(options.max_detections),
      walk_({}, 1, set),
      ahead_({}, 1, set, 0, 0, 0) {
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
  walk_ = RayWalk(views_, scale_mm, set);
  if (options.threads > 1)
    ahead_ = WalksAhead(views_, scale_mm, set, options.threads, options.max_detections, options.max_matches);
  matches_.reserve(options.max_matches);
  next_match_.resize(options.max_matches);
  for (std::size_t v = 0; v < views.size(); ++v) {
    first_match_[v].resize(options.max_detections);
    settled_[v].resize(options.max_detections);
  }
}

void Correspondence::look(std::size_t view, const Detections& seen) noexcept {
  unusable_[view] = views_[view].look(seen);
  std::fill_n(settled_[view].begin(), views_[view].size(), std::uint8_t{0});
  std::fill_n(first_match_[view].begin(), views_[view].size(), kUnseen);
  if (view == 1 && lines_[0][1].usable) pencil_.build(lines_[0][1], views_[1]);  // the pair that match() begins with
}

std::span<const ViewMatch> Correspondence::match(std::span<const Detections> seen) noexcept {
  parallel_for(views_.size(), options_.threads, [&](std::size_t view, std::size_t) { look(view, seen[view]); });
  return match();
}

std::span<const ViewMatch> Correspondence::match() noexcept {
  matches_.clear();
  work_ = 0;
  counts_.rays = counts_.pairs = counts_.tuples = 0;
  for (std::size_t v = 0; v < views_.size(); ++v) counts_.unusable_detections += unusable_[v];
  std::size_t settled = 0;  // matches that settle() has seen
  for (std::size_t first = 0; first + options_.min_views <= views_.size(); ++first)
    for (std::size_t second = first + 1; second + options_.min_views <= views_.size() + 1; ++second) {
      if (second > 1 && lines_[first][second].usable) pencil_.build(lines_[first][second], views_[second]);
      search(first, second);
      settle(std::exchange(settled, matches_.size()));
    }
  return matches_;
}

WalkedViews Correspondence::walked() const noexcept {
  return {views_, settled_, half_mm_, options_.min_views, options_.tolerance_px};
}

// What was walked ahead is what a walk here would find, unless the work is used up on the way.
void Correspondence::search(std::size_t first, std::size_t second) noexcept {
  constexpr std::size_t kStretch = WalksAhead::kStretch, kWorthThreads = 2 * kStretch;  // rays
  const std::uint64_t most_work = kWorkPerMatch * options_.max_matches;
  const EpipolarPencil* pencil = lines_[first][second].usable ? &pencil_ : nullptr;
  const std::size_t rays = views_[first].size();
  const auto left = std::count(settled_[first].begin(), settled_[first].begin() + static_cast<std::ptrdiff_t>(rays), 0);
  const bool ahead = ahead_.threads() > 1 && static_cast<std::size_t>(left) >= kWorthThreads && work_ <= most_work;
  if (ahead) ahead_.walk(walked(), first, second, pencil, rays, most_work - work_);
  List list(*this);
  for (std::size_t from = 0; from < rays; from += kStretch) {
    if (ahead) {
      const WalksAhead::Stretch& stretch = ahead_.stretch(from / kStretch);
      if (stretch.whole && work_ + stretch.counts.work <= most_work) {
        for (const ViewMatch& match : ahead_.found(stretch)) list.take(match);
        count(stretch.counts);
        continue;
      }
    }
    WalkCounts counts;
    counts.work = work_;
    walk_.walk(walked(), {first, second, pencil, from, std::min(from + kStretch, rays)}, most_work, list, counts);
    counts.work -= work_;
    count(counts);
  }
}

void Correspondence::count(const WalkCounts& counts) noexcept {
  work_ += counts.work;
  counts_.unsearched += counts.unsearched, counts_.refused_hits += counts.refused_hits;
  counts_.rays += counts.rays, counts_.pairs += counts.pairs, counts_.tuples += counts.tuples;
}

std::span<const ViewMatch> Correspondence::add(std::span<const ViewTuple> tuples) noexcept {
  const std::size_t before = matches_.size();
  for (std::size_t v = 0; v < views_.size(); ++v) std::fill_n(first_match_[v].begin(), views_[v].size(), kUnseen);
  List list(*this);
  WalkCounts counts;
  walk_.judge(walked(), tuples, list, counts);
  count(counts);
  return std::span<const ViewMatch>(matches_).subspan(before);
}

bool Correspondence::List::take(const ViewMatch& match) noexcept {
  if (of.listed(match.tuple)) return true;
  if (of.matches_.size() == of.options_.max_matches) {
    ++of.counts_.refused_matches;
    return true;
  }
  const auto number = static_cast<std::uint32_t>(of.matches_.size());
  of.matches_.push_back(match);
  for (std::size_t v = 0; v < of.views_.size(); ++v) {
    if (match.tuple.detection[v] == kUnseen) continue;
    of.next_match_[number][v] = std::exchange(of.first_match_[v][match.tuple.detection[v]], number);
  }
  return true;
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
