// SPDX-License-Identifier: MIT
// The sums of the N-ray fit over many rays at once.
#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/light_field/n_ray_fit_kernel.hpp"
#include "reconstruct/light_field/ray_gate_kernel.hpp"

namespace rptv {

/// Rays as columns. Memory is taken by the constructor.
class RayColumns {
 public:
  explicit RayColumns(std::size_t capacity)
      : centre_x(capacity + kPadding), centre_y(centre_x), slope_x(centre_x), slope_y(centre_x) {}

  std::size_t capacity() const noexcept { return centre_x.size() - kPadding; }
  void push(const Ray& ray) noexcept { push_if(ray, true); }
  /// Written either way, for whether it counts cannot be predicted.
  void push_if(const Ray& ray, bool counts) noexcept {
    centre_x[size] = ray.centre_x, centre_y[size] = ray.centre_y;
    slope_x[size] = ray.slope_x, slope_y[size] = ray.slope_y;
    size += counts ? 1 : 0;
  }
  Ray operator[](std::size_t i) const noexcept { return {centre_x[i], centre_y[i], slope_x[i], slope_y[i]}; }
  static constexpr std::size_t kPadding = 16;  // a whole vector may be read or written behind the last ray
  std::vector<float> centre_x, centre_y, slope_x, slope_y;
  std::size_t size = 0;
};

/// Sums with weight 1 over the rays within `half_width_mm` of the gate's middle at `at`; what RaySums::add() gives ray
/// by ray, to single precision. Eight lanes in a fixed order: the same bits on every processor.
RaySums sum_rays(const RayColumns& rays, const RayGate& gate, const ImagePoint& at, double half_width_mm) noexcept;

}  // namespace rptv
