// SPDX-License-Identifier: MIT
// Where background and thresholds start.
#include "reconstruct/dark_pixels.hpp"

#include <fmt/format.h>

#include "core/error.hpp"

namespace rptv {

namespace {

std::vector<float> mean_of(const DarkSettings& settings, const ImageShape& shape, const ImageView& background,
                           std::span<const float> known) {
  if (background.data == nullptr) {
    if (settings.background > 0 || known.empty())
      return std::vector<float>(shape.pixels(), static_cast<float>(settings.background));
    return {known.begin(), known.end()};
  }
  if (!background.shape.has_size_of(shape))
    throw Error(ExitCode::configuration,
                fmt::format("{}: the background is {}x{} px but the camera has {}x{}; take it with the same camera",
                            settings.background_image, background.shape.width_px, background.shape.height_px,
                            shape.width_px, shape.height_px));
  std::vector<float> mean(shape.pixels());
  for (std::size_t i = 0; i < mean.size(); ++i)
    mean[i] =
        static_cast<float>(background.shape.bytes_per_pixel == 1 ? background.as_u8()[i] : background.as_u16()[i]);
  return mean;
}

}  // namespace

DarkPixels make_dark(const DarkSettings& settings, const ImageShape& shape, const ImageView& background,
                     const KnownPixels& known) {
  std::vector<float> mean = mean_of(settings, shape, background, known.level);
  DarkLimit limit(shape, settings.background, settings.threshold);
  const bool uniform = background.data == nullptr && known.level.empty() && known.share.empty() && known.noise.empty();
  if (!uniform) limit.follow(mean, known.noise, known.share, settings.threshold, settings.threshold_sigmas);
  return {std::move(mean), std::move(limit)};
}

}  // namespace rptv
