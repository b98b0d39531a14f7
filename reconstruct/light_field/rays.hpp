// SPDX-License-Identifier: MIT
// The rays of one frame: the pre-filtered matrix Q of eq. (5), sorted by lenslet.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/ray.hpp"

namespace rptv {

/// Rays in order of their lenslet's number. `pixel[i]` numbers the lit pixel that ray i comes from: where sub-images
/// overlap, several rays (hypotheses) share one pixel, and `same_pixel` leads round in a ring from each to the next.
/// Capacity is fixed by the constructor.
class Rays {
 public:
  Rays(std::size_t capacity, std::size_t lenslets)
      : ray(capacity),
        pixel(capacity),
        kept_lenslets(2 * capacity),
        same_pixel(capacity),
        first_of_lenslet(lenslets + 1) {}

  std::size_t capacity() const noexcept { return ray.size(); }
  std::span<const Ray> all() const noexcept { return {ray.data(), size}; }

  std::vector<Ray> ray;
  std::vector<std::uint32_t> pixel;
  std::vector<std::uint32_t> kept_lenslets;     ///< for PixelsToRays::convert() alone
  std::vector<std::uint32_t> same_pixel;        ///< another ray of the same pixel; the ray itself where there is none
  std::vector<std::uint32_t> first_of_lenslet;  ///< rays of lenslet l: first_of_lenslet[l] … first_of_lenslet[l + 1]
  std::size_t size = 0;
  std::size_t pixels = 0;  ///< lit pixels that have a ray
};

}  // namespace rptv
