// SPDX-License-Identifier: MIT
// The rays of a frame as they lie on the device.
#pragma once

#include <cstdint>

#include "reconstruct/light_field/ray.hpp"

namespace rptv {

/// Rays, in the order and with the meaning of class Rays. All pointers are the device's.
struct CudaRays {
  Ray* ray;                           ///< capacity
  std::uint32_t *pixel, *same_pixel;  ///< capacity each
  std::uint32_t* first_of_lenslet;    ///< lenslets + 1
  std::uint32_t *size, *pixels;       ///< one each: rays, and lit pixels that have a ray
  std::uint32_t capacity, lenslets;
};

}  // namespace rptv
