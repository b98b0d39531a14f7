// SPDX-License-Identifier: MIT
// The microlens array: which lenslet a ray meets, and where on the sensor it lands.
#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "simulation/lens_tracer.hpp"
#include "simulation/main_lens.hpp"

namespace rptv {

using Lenslet = std::array<long, 2>;  ///< column and row of the lattice

/// Square cells on offset + pitch Rot(rotation) (iu, iv); sensor in the focal plane behind. Immutable; any thread.
class LensletArray {
 public:
  explicit LensletArray(const LensletArraySettings& settings);

  /// Nearest true lenslet to a point of the array plane, mm.
  Lenslet at(double x_mm, double y_mm) const noexcept {
    const double x = (x_mm - offset_x_) / pitch_, y = (y_mm - offset_y_) / pitch_;
    return {std::lround(cos_ * x + sin_ * y), std::lround(-sin_ * x + cos_ * y)};
  }
  std::array<double, 2> centre(Lenslet lenslet) const noexcept {
    const auto u = static_cast<double>(lenslet[0]), v = static_cast<double>(lenslet[1]);
    return {offset_x_ + pitch_ * (cos_ * u - sin_ * v), offset_y_ + pitch_ * (sin_ * u + cos_ * v)};
  }
  /// Sensor position, mm, of a ray through a lenslet. Thin: centre + f slope; plano-convex: Snell at sphere and plane.
  /// Not finite when the ray is totally reflected.
  std::array<double, 2> land(const ArrayRay& ray, Lenslet lenslet) const noexcept {
    const auto middle = centre(lenslet);
    if (refracting_) return refracted(ray, middle);
    return {middle[0] + focal_ * ray.slope_x, middle[1] + focal_ * ray.slope_y};
  }
  double focal_length_mm() const noexcept { return focal_; }
  double pitch_mm() const noexcept { return pitch_; }

 private:
  std::array<double, 2> refracted(const ArrayRay& ray, std::array<double, 2> centre) const noexcept;

  double pitch_, focal_, offset_x_, offset_y_, cos_, sin_;
  std::optional<LensTracer> refracting_;
  double sensor_z_mm_ = 0;  ///< behind the vertices
};

}  // namespace rptv
