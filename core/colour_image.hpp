// SPDX-License-Identifier: MIT
// A picture for people: red, green, blue, 8 bits each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rptv {

using Colour = std::array<std::uint8_t, 3>;

/// Row-major; rows grow downwards.
struct ColourImage {
  int width = 0, height = 0;
  std::vector<Colour> pixels;

  ColourImage(int columns, int rows, Colour fill)
      : width(columns),
        height(rows),
        pixels(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), fill) {}
  /// Ignored outside.
  void set(int column, int row, Colour colour) noexcept {
    if (column >= 0 && row >= 0 && column < width && row < height)
      pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)] =
          colour;
  }
};

}  // namespace rptv
