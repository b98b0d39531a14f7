// SPDX-License-Identifier: MIT
// The particles found in one frame set, as a structure of arrays of fixed capacity.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rptv {

/// Symmetric 3×3 covariance in mm²: xx, xy, xz, yy, yz, zz.
using Covariance = std::array<double, 6>;

/// One particle, for passing by value. Positions and residual in mm; frame of reference: object space (DESIGN: x, y
/// parallel to the sensor, z towards the lens; multi-view: the rig's frame) unless the stage was asked for image space.
struct Particle {
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double residual_mm = 0;  ///< rms distance of its rays from the point
  double support = 0;      ///< rays (light field) or views (multi-view) that it explains
  Covariance covariance_mm2{};
  double ghost = 0;  ///< probability that there is no such particle
};

/// Arrays of equal length size(). All memory is taken by the constructor; push() never allocates. One thread at a time.
class Particles {
 public:
  explicit Particles(std::size_t capacity = 0) {
    for (auto* column : {&x_mm, &y_mm, &z_mm, &residual_mm, &support, &ghost}) column->reserve(capacity);
    covariance_mm2.reserve(capacity);
    capacity_ = capacity;
  }
  std::size_t size() const noexcept { return x_mm.size(); }
  std::size_t capacity() const noexcept { return capacity_; }
  std::uint64_t overflow() const noexcept { return overflow_; }  ///< particles refused since clear()

  void clear() noexcept {
    for (auto* column : {&x_mm, &y_mm, &z_mm, &residual_mm, &support, &ghost}) column->clear();
    covariance_mm2.clear();
    overflow_ = 0;
  }
  /// False, and counted, when full.
  bool push(const Particle& p) noexcept {
    if (size() == capacity_) {
      ++overflow_;
      return false;
    }
    x_mm.push_back(p.x_mm);
    y_mm.push_back(p.y_mm);
    z_mm.push_back(p.z_mm);
    residual_mm.push_back(p.residual_mm);
    support.push_back(p.support);
    covariance_mm2.push_back(p.covariance_mm2);
    ghost.push_back(p.ghost);
    return true;
  }

  std::vector<double> x_mm, y_mm, z_mm, residual_mm, support, ghost;
  std::vector<Covariance> covariance_mm2;

 private:
  std::size_t capacity_ = 0;
  std::uint64_t overflow_ = 0;
};

}  // namespace rptv
