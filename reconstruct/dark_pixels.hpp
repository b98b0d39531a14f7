// SPDX-License-Identifier: MIT
// What pixels look like without particles, and above which grey value they are lit.
#pragma once

#include <vector>

#include "core/image.hpp"
#include "reconstruct/light_field_settings.hpp"
#include "reconstruct/lit_pixels.hpp"

namespace rptv {

struct DarkPixels {
  std::vector<float> mean;  ///< grey value without light, row by row
  DarkLimit limit;
};

/// From an image without particles; without data, from the constant settings.background. Throws Error(configuration)
/// when the image has another shape.
DarkPixels make_dark(const LightFieldSettings& settings, const ImageShape& shape, const ImageView& background);

}  // namespace rptv
