// SPDX-License-Identifier: MIT
// What pixels look like without particles, and above which grey value they are lit.
#pragma once

#include <span>
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
  double threshold_sigmas = 0;   ///< where the noise of pixels is known: at least this many of it
};

/// What is known about the pixels before, row by row; empty where nothing is.
struct KnownPixels {
  std::span<const float> level;  ///< grey value without light
  std::span<const float> noise;  ///< its rms, grey values
  std::span<const float> share;  ///< of the light of a particle that reaches the pixel, over that on the axis
};

/// Grey values without light from an image without particles; without data, from `settings.background`, or where that
/// is 0 and `known` has a level, from there. Limits: the threshold, times the share where that is known, but no less
/// than `threshold_sigmas` of the noise. Throws Error(configuration) when the image has another shape.
DarkPixels make_dark(const DarkSettings& settings, const ImageShape& shape, const ImageView& background,
                     const KnownPixels& known = {});

}  // namespace rptv
