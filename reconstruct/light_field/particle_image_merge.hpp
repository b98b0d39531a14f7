// SPDX-License-Identifier: MIT
// Where sub-images overlap, a particle's image has a pixel several times: adds them up.
#pragma once

#include <cstdint>
#include <span>

#include "reconstruct/light_field/particle_image.hpp"

namespace rptv {

/// The rectangle of the sensor that the image lies in.
struct ImageBox {
  std::int32_t column, row, width, height;
  std::int32_t sensor_width;
};

/// Leaves one entry a pixel, in order of first appearance. `place` is a workspace with an element per pixel of the box;
/// false, and the image unchanged, when it is too small.
bool merge_pixels(ParticleImage& image, const ImageBox& box, std::span<std::uint32_t> place) noexcept;

}  // namespace rptv
