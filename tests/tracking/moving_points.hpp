// SPDX-License-Identifier: MIT
// Seeded point clouds in motion, with the truth beside them: the workloads of the linker's tests and benchmark.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "core/particles.hpp"
#include "tests/tracking/abc_flow.hpp"

namespace rptv {

/// `count` points in a cube, mean spacing 1 mm; every frame in another order. They all stay in view, but for those that
/// a flow carries out of the cube: another one comes in on the other side then.
class MovingPoints {
 public:
  /// walk: uniform in a ball of radius `ratio`; gauss: normal with r.m.s. length `ratio`; flow: steady ABC flow with
  /// one wave across the cube and top speed `ratio` a frame, plus normal steps of 2 % of that.
  enum class Steps { walk, gauss, flow };

  MovingPoints(std::size_t count, Steps steps, double ratio, std::uint64_t seed)
      : steps_(steps),
        ratio_(ratio),
        side_(std::cbrt(static_cast<double>(count))),
        flow_(side_, ratio),
        random_(seed),
        order_(count),
        points_(count) {
    std::uniform_real_distribution<double> place(0, side_);
    for (auto& p : points_) p = {place(random_), place(random_), place(random_)};
    std::iota(order_.begin(), order_.end(), 0U);
    next_identity_.assign(order_.begin(), order_.end());
    identity_ = next_identity_;
  }

  /// Fills `out` (capacity: count) with the present positions, then moves every point.
  void next(Particles& out) {
    std::shuffle(order_.begin(), order_.end(), random_);
    out.clear();
    for (const std::uint32_t i : order_) out.push({points_[i].x, points_[i].y, points_[i].z, 0, 0, {}});
    identity_ = next_identity_;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      Point& p = points_[i];
      const Point d = step(p);
      p = {p.x + d.x, p.y + d.y, p.z + d.z};
      if (steps_ != Steps::flow) continue;
      const bool leaves = wrap(p.x) | wrap(p.y) | wrap(p.z);
      if (leaves) next_identity_[i] += points_.size();
    }
  }
  /// Which place in a list of `count` row i of the last frame has: the same for a point in every frame.
  const std::vector<std::uint32_t>& truth() const { return order_; }
  /// By that place: who is there in the last frame; another one after each change.
  const std::vector<std::uint64_t>& identity() const { return identity_; }

  using Point = AbcFlow::Point;
  /// Positions before next() and how far each moves in the first frame, of every fifth point: a peer gets it too.
  std::vector<std::pair<Point, Point>> known_flow() const {
    std::vector<std::pair<Point, Point>> known;
    for (std::size_t i = 0; i < points_.size(); i += 5) known.emplace_back(points_[i], flow_.step(points_[i]));
    return known;
  }

 private:
  bool wrap(double& v) const {
    const bool leaves = v < 0 || v >= side_;
    if (leaves) v -= side_ * std::floor(v / side_);
    return leaves;
  }
  Point step(const Point& p) {
    if (steps_ != Steps::walk) {
      const bool flows = steps_ == Steps::flow;
      std::normal_distribution<double> normal(0, (flows ? 0.02 : 1.0) * ratio_ / std::sqrt(3.0));
      const Point d = flows ? flow_.step(p) : Point{0, 0, 0};
      return {d.x + normal(random_), d.y + normal(random_), d.z + normal(random_)};
    }
    std::uniform_real_distribution<double> side(-1, 1);
    while (true) {
      const Point d{side(random_), side(random_), side(random_)};
      if (d.x * d.x + d.y * d.y + d.z * d.z <= 1) return {d.x * ratio_, d.y * ratio_, d.z * ratio_};
    }
  }

  Steps steps_;
  double ratio_, side_;
  AbcFlow flow_;
  std::mt19937_64 random_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint64_t> identity_, next_identity_;
  std::vector<Point> points_;
};

}  // namespace rptv
