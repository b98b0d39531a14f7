// SPDX-License-Identifier: MIT
// Where background and thresholds start.
#include "reconstruct/dark_pixels.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace rptv {

DarkPixels make_dark(const DarkSettings& settings, const ImageShape& shape, const ImageView& background) {
  std::vector<float> mean(shape.pixels(), static_cast<float>(settings.background));
  if (background.data == nullptr) return {std::move(mean), DarkLimit(shape, settings.background, settings.threshold)};
  if (!background.shape.has_size_of(shape))
    throw Error(ExitCode::configuration,
                fmt::format("{}: the background is {}x{} px but the camera has {}x{}; take it with the same camera",
                            settings.background_image, background.shape.width_px, background.shape.height_px,
                            shape.width_px, shape.height_px));
  for (std::size_t i = 0; i < mean.size(); ++i)
    mean[i] =
        static_cast<float>(background.shape.bytes_per_pixel == 1 ? background.as_u8()[i] : background.as_u16()[i]);
  return {std::move(mean), DarkLimit(background, settings.threshold)};
}

}  // namespace rptv
