// SPDX-License-Identifier: MIT
// The microlens array: which lenslet a ray meets, and where on the sensor it lands.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "simulation/lens_tracer.hpp"
#include "simulation/main_lens.hpp"

namespace rptv {

using Lenslet = std::array<long, 2>;     ///< column and row of the lattice
using SensorMm = std::array<double, 2>;  ///< point of the sensor from the axis, mm

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
  /// Sensor positions, mm, of rays that each go through the lenslet they meet, or all through `lenslet` when it is
  /// given. Thin: centre + f slope; plano-convex: Snell at sphere and plane, not finite where totally reflected. Rays
  /// without weight count for nothing. at.size() == rays.size().
  void land(std::span<const ArrayRay> rays, std::optional<Lenslet> lenslet, std::span<SensorMm> at) const noexcept;
  double focal_length_mm() const noexcept { return focal_; }
  double pitch_mm() const noexcept { return pitch_; }

 private:
  void refract(std::span<const ArrayRay> rays, std::span<SensorMm> at) const noexcept;

  double pitch_, focal_, offset_x_, offset_y_, cos_, sin_;
  std::optional<LensTracer> refracting_;
  double sensor_z_mm_ = 0;  ///< behind the vertices
};

}  // namespace rptv
