// SPDX-License-Identifier: MIT
// The steady flow of Arnold, Beltrami and Childress, one wave across a cube.
#pragma once

#include <cmath>
#include <numbers>

namespace rptv {

/// Dombre et al., J. Fluid Mech. 167 (1986) 353, with A = B = C. Lengths in mm, times in frames.
class AbcFlow {
 public:
  struct Point {
    double x, y, z;
  };
  AbcFlow(double side, double top_speed)
      : k_(2 * std::numbers::pi / side), scale_(top_speed / std::sqrt(6.0)) {}  // |u| is at most sqrt(6)

  Point velocity(const Point& p) const {
    return {scale_ * (std::sin(k_ * p.z) + std::cos(k_ * p.y)), scale_ * (std::sin(k_ * p.x) + std::cos(k_ * p.z)),
            scale_ * (std::sin(k_ * p.y) + std::cos(k_ * p.x))};
  }
  /// Displacement in one frame, by the midpoint rule.
  Point step(const Point& p) const {
    const Point half = velocity(p);
    return velocity({p.x + half.x / 2, p.y + half.y / 2, p.z + half.z / 2});
  }

 private:
  double k_, scale_;
};

}  // namespace rptv
