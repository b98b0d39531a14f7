// SPDX-License-Identifier: MIT
// One pass with a map of the box.
#include "reconstruct/light_field/particle_image_merge.hpp"

#include <algorithm>

namespace rptv {

bool merge_pixels(ParticleImage& image, const ImageBox& box, std::span<std::uint32_t> place) noexcept {
  const auto pixels = static_cast<std::size_t>(box.width) * static_cast<std::size_t>(box.height);
  if (pixels > place.size()) return false;
  std::fill_n(place.begin(), pixels, 0U);  // 0: not met yet; else its entry, plus 1
  std::size_t to = 0;
  for (std::size_t i = 0; i < image.size; ++i) {
    const auto pixel = static_cast<std::int32_t>(image.pixel[i]);
    const std::int32_t row = pixel / box.sensor_width - box.row, column = pixel % box.sensor_width - box.column;
    auto& entry = place[static_cast<std::size_t>(row * box.width + column)];
    if (entry == 0) {
      image.pixel[to] = image.pixel[i], image.value[to] = image.value[i];
      image.dx[to] = image.dx[i], image.dy[to] = image.dy[i], image.dz[to] = image.dz[i];
      entry = static_cast<std::uint32_t>(++to);
    } else {
      image.value[entry - 1] += image.value[i];
      image.dx[entry - 1] += image.dx[i], image.dy[entry - 1] += image.dy[i], image.dz[entry - 1] += image.dz[i];
    }
  }
  image.size = to;
  return true;
}

}  // namespace rptv
