// SPDX-License-Identifier: MIT
// An image as numbers, for set-up work.
#pragma once

#include <cstddef>
#include <vector>

#include "core/image.hpp"

namespace rptv {

/// Row-major grey values.
struct GreyImage {
  int width = 0, height = 0;
  std::vector<float> grey;

  GreyImage() = default;
  GreyImage(int columns, int rows, float value = 0)
      : width(columns), height(rows), grey(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), value) {}
  explicit GreyImage(const ImageView& view)
      : GreyImage(static_cast<int>(view.shape.width_px), static_cast<int>(view.shape.height_px)) {
    for (std::size_t i = 0; i < grey.size(); ++i)
      grey[i] = static_cast<float>(view.shape.bytes_per_pixel == 1 ? view.as_u8()[i] : view.as_u16()[i]);
  }

  float& at(int column, int row) noexcept {
    return grey[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
  float at(int column, int row) const noexcept {
    return grey[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
};

}  // namespace rptv
