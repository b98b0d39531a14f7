// SPDX-License-Identifier: MIT
// The walk: a ray's neighbours in a second view, each of them in the later views, sets solved eight at a time.
#include "reconstruct/multi_view/ray_walk.hpp"

#include <cmath>

#include "reconstruct/multi_view/epipolar.hpp"

namespace rptv {

static_assert(kMaxViews <= 32, "RayWalk::lined_ has a bit a view");

/// Two detections: the ray of the first, and the depth on it that the second gives.
struct RayWalk::Seed {
  Sight sight;
  double t, depth_error_mm;
  double px_per_mm;  ///< of the first view
};

RayWalk::RayWalk(std::span<const SeenView> views, double scale_mm, InstructionSet set) : solver_(views, scale_mm, set) {
  doubtful_.reserve(2 * kDltLanes * kMaxViews);
}

void RayWalk::begin(const WalkedViews& seen, MatchSink& sink, WalkCounts& counts) noexcept {
  seen_ = &seen, sink_ = &sink, counts_ = &counts;
  room_ = true;
  solver_.clear();
  doubtful_.clear();
}

bool RayWalk::walk(const WalkedViews& seen, const RayStretch& stretch, std::uint64_t most_work, MatchSink& sink,
                   WalkCounts& counts) noexcept {
  begin(seen, sink, counts);
  const SeenView& first = seen.views[stretch.first];
  for (std::size_t i = stretch.from; i < stretch.until && room_; ++i) {
    if (counts.work > most_work)
      ++counts.unsearched;
    else if (first.usable(i) && seen.settled[stretch.first][i] == 0)
      follow(stretch, i);
  }
  solve(true);
  return room_;
}

void RayWalk::judge(const WalkedViews& seen, std::span<const ViewTuple> tuples, MatchSink& sink,
                    WalkCounts& counts) noexcept {
  begin(seen, sink, counts);
  for (const ViewTuple& tuple : tuples) propose(tuple);
  solve(true);
}

void RayWalk::follow(const RayStretch& stretch, std::size_t detection) noexcept {
  const SeenView &first = seen_->views[stretch.first], &second = seen_->views[stretch.second];
  Seed seed;
  first.sight(detection, seed.sight.from_mm, seed.sight.along);
  if (!clip(seen_->half_mm, seed.sight)) return;
  ++counts_->rays;
  lined_ = 0;
  const ViewRays& rays = second.rays();
  seed.px_per_mm = first.rays().px_per_mm();
  const EpipolarLine line(rays.pinhole(), seed.sight);
  const double error_px = across_px(seen_->tolerance_px, rays.px_per_mm(), seed.px_per_mm);
  const auto visit = [&](std::uint32_t found, double t) {
    ++counts_->pairs;
    ++counts_->work;
    if (seen_->settled[stretch.second][found] != 0) return;
    seed.t = t;
    if (rays.wander_px() > kNoWander_px && !meets(seed, stretch.second, found, error_px)) return;
    seed.depth_error_mm = depth_error_mm(error_px, line.place(seed.t));
    ViewTuple tuple = ViewTuple::none();
    tuple.put(stretch.first, static_cast<std::uint32_t>(detection));
    tuple.put(stretch.second, found);
    extend(seed, tuple, stretch.second + 1);
  };
  if (stretch.pencil != nullptr)
    stretch.pencil->visit_near(line, seed.sight, error_px + rays.wander_px(), visit);
  else
    visit_along(second, line, seed.sight, error_px + rays.wander_px(), visit);
}

// Where refraction makes rays wander in the pinhole image, they are asked themselves.
bool RayWalk::meets(Seed& seed, std::size_t view, std::uint32_t detection, double error_px) const noexcept {
  const SeenView& seen = seen_->views[view];
  Point3 from_mm, along;
  seen.sight(detection, from_mm, along);
  seed.t = nearest_depth(seed.sight, from_mm, along);
  const auto miss = miss_px(seen.ray(detection), seen.rays().axes(), seed.sight.from_mm + seed.t * seed.sight.along);
  return miss[0] * miss[0] + miss[1] * miss[1] <= error_px * error_px;
}

void RayWalk::extend(const Seed& seed, ViewTuple& tuple, std::size_t view) noexcept {
  const std::size_t start = view, views = seen_->views.size();
  for (; view < views && tuple.views + views - view >= seen_->min_views; ++view) {
    std::array<std::uint32_t, kMostHits> hit;
    const std::size_t hits = ask(seed, view, hit);
    for (std::size_t h = 1; h < hits; ++h) {
      tuple.put(view, hit[h]);
      extend(seed, tuple, view + 1);
    }
    tuple.put(view, hits > 0 ? hit[0] : kUnseen);
  }
  if (tuple.views >= seen_->min_views) propose(tuple);
  for (std::size_t v = start; v < views; ++v) tuple.put(v, kUnseen);
}

const EpipolarLine& RayWalk::line_in(std::size_t view, const Sight& sight) noexcept {
  if ((lined_ >> view & 1U) == 0) {
    line_[view] = EpipolarLine(seen_->views[view].rays().pinhole(), sight);
    lined_ |= 1U << view;
  }
  return line_[view];
}

std::size_t RayWalk::ask(const Seed& seed, std::size_t view, std::array<std::uint32_t, kMostHits>& hit) noexcept {
  const SeenView& seen = seen_->views[view];
  const ViewRays& rays = seen.rays();
  const AskedPlace at(line_in(view, seed.sight).place(seed.t), seen_->tolerance_px,
                      across_px(seen_->tolerance_px, rays.px_per_mm(), seed.px_per_mm), seed.depth_error_mm);
  const bool wanders = rays.wander_px() > kNoWander_px;
  const double reach_u = at.reach_u() + rays.wander_px(), reach_v = at.reach_v() + rays.wander_px();
  const Point3 place = seed.sight.from_mm + seed.t * seed.sight.along;
  std::size_t hits = 0;
  seen.across_u().around(at.u, at.v, reach_u, reach_v, [&](const auto& point) {
    ++counts_->work;
    if (seen_->settled[view][point.number] != 0) return;
    std::array<double, 2> off{at.u - point.major, at.v - point.minor};
    if (wanders) off = miss_px(seen.ray(point.number), rays.axes(), place);
    if (!at.holds(off[0], off[1])) return;
    if (hits < hit.size())
      hit[hits++] = point.number;
    else
      ++counts_->refused_hits;
  });
  return hits;
}

void RayWalk::propose(const ViewTuple& tuple) noexcept {
  solver_.push(tuple);
  if (solver_.full()) solve(false);
}

// A tuple that does not meet is tried without its worst view; and where one view less is the least there may be,
// without any one of its views.
void RayWalk::solve(bool all) noexcept {
  while (solver_.full() || (all && !solver_.empty())) {
    solver_.solve([this](const ViewMatch& found, std::size_t worst, double worst_px) {
      ++counts_->tuples;
      ++counts_->work;
      if (worst_px <= seen_->tolerance_px) return accept(found);
      if (found.tuple.views <= seen_->min_views) return;
      for (std::size_t v = 0; v < seen_->views.size(); ++v) {
        if (found.tuple.detection[v] == kUnseen) continue;
        if (v != worst && found.tuple.views > seen_->min_views + 1) continue;
        doubtful_.push_back(found.tuple);
        doubtful_.back().put(v, kUnseen);
      }
    });
    for (; !doubtful_.empty() && !solver_.full(); doubtful_.pop_back()) solver_.push(doubtful_.back());
  }
}

void RayWalk::accept(const ViewMatch& match) noexcept {
  for (std::size_t k = 0; k < 3; ++k)
    if (std::abs(match.at_mm[k]) > seen_->half_mm[k]) return;
  room_ = sink_->take(match) && room_;
}

}  // namespace rptv
