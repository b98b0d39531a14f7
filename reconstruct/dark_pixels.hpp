// SPDX-License-Identifier: MIT
// What pixels look like without particles, and above which grey value they are lit.
#pragma once

#include <string>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/lit_pixels.hpp"

namespace rptv {

struct DarkPixels {
  std::vector<float> mean;  ///< grey value without light, row by row
  DarkLimit limit;
};

/// What is said about the dark in a configuration, grey values.
struct DarkSettings {
  double background = 0;         ///< of all pixels, where there is no image of it
  double threshold = 0;          ///< over the background
  std::string background_image;  ///< its name, for messages
};

/// From an image without particles; without data, from the constant settings.background. Throws Error(configuration)
/// when the image has another shape.
DarkPixels make_dark(const DarkSettings& settings, const ImageShape& shape, const ImageView& background);

}  // namespace rptv
