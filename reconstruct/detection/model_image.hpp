// SPDX-License-Identifier: MIT
// The sum of the Gaussians of all spots that overlap, as an image.
#pragma once

#include <vector>

#include "core/huge_pages.hpp"
#include "core/image.hpp"
#include "reconstruct/detection/fitted_spot.hpp"

namespace rptv {

/// All memory is taken by the constructor. One thread. Zero outside of what was added.
class ModelImage {
 public:
  static constexpr std::int32_t kMostReach = 12;  ///< pixels from a spot's middle that its Gaussian is added to
  static constexpr double kMostMove = 2;          ///< pixels that a spot may move away from its start

  explicit ModelImage(const ImageShape& shape);

  /// Pixels from its middle that a spot's Gaussian is seen, at most kMostReach; 0: nowhere.
  static std::int32_t reach(const FittedSpot& spot) noexcept;

  void add(const FittedSpot& spot) noexcept;
  /// Zero again wherever that spot may have been added.
  void clear(const FittedSpot& spot) noexcept;
  float at(std::size_t pixel) const noexcept { return light_[pixel]; }

 private:
  struct Box {
    std::int32_t first_x, last_x, first_y, last_y;
  };
  Box box(std::int32_t x, std::int32_t y, std::int32_t reach) const noexcept;

  const std::int32_t width_, height_;
  std::vector<float, HugePages<float>> light_;
};

}  // namespace rptv
