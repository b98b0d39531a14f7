// SPDX-License-Identifier: MIT
// Seeded point clouds in motion, with the truth beside them: the workloads of the linker's tests and benchmark.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>
#include <vector>

#include "core/particles.hpp"

namespace rptv {

/// `count` points in a cube, mean spacing 1 mm, that all stay in view; every frame in another order.
/// truth()[i]: which point row i of the frame's particles is.
class MovingPoints {
 public:
  enum class Steps { walk, gauss };  ///< uniform in a ball of radius `ratio`; normal with r.m.s. length `ratio`

  MovingPoints(std::size_t count, Steps steps, double ratio, std::uint64_t seed)
      : steps_(steps), ratio_(ratio), random_(seed), order_(count), points_(count) {
    std::uniform_real_distribution<double> place(0, std::cbrt(static_cast<double>(count)));
    for (auto& p : points_) p = {place(random_), place(random_), place(random_)};
    std::iota(order_.begin(), order_.end(), 0U);
  }

  /// Fills `out` (capacity: count) with the present positions, then moves every point.
  void next(Particles& out) {
    std::shuffle(order_.begin(), order_.end(), random_);
    out.clear();
    for (const std::uint32_t i : order_) out.push({points_[i].x, points_[i].y, points_[i].z, 0, 0, {}});
    for (auto& p : points_) {
      const Point d = step();
      p = {p.x + d.x, p.y + d.y, p.z + d.z};
    }
  }
  const std::vector<std::uint32_t>& truth() const { return order_; }

 private:
  struct Point {
    double x, y, z;
  };
  Point step() {
    if (steps_ == Steps::gauss) {
      std::normal_distribution<double> normal(0, ratio_ / std::sqrt(3.0));
      return {normal(random_), normal(random_), normal(random_)};
    }
    std::uniform_real_distribution<double> side(-1, 1);
    while (true) {
      const Point d{side(random_), side(random_), side(random_)};
      if (d.x * d.x + d.y * d.y + d.z * d.z <= 1) return {d.x * ratio_, d.y * ratio_, d.z * ratio_};
    }
  }

  Steps steps_;
  double ratio_;
  std::mt19937_64 random_;
  std::vector<std::uint32_t> order_;
  std::vector<Point> points_;
};

}  // namespace rptv
