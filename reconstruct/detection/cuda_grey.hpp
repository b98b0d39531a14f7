// SPDX-License-Identifier: MIT
// Grey values of an image on the device, as GreyOverBackground, and the square of a spot in it.
#pragma once

#include "reconstruct/cuda_device.hpp"
#include "reconstruct/detection/image_cuda.hpp"
#include "reconstruct/detection/spot_centre.hpp"

namespace rptv {

template <class Pixel>
struct CudaGrey {
  const Pixel* pixels;
  CudaDark known_dark;
  std::int32_t width_px, height_px;
  float saturation_grey;

  __device__ std::int32_t width() const { return width_px; }
  __device__ std::int32_t height() const { return height_px; }
  __device__ std::size_t index(std::int32_t x, std::int32_t y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_px) + static_cast<std::size_t>(x);
  }
  __device__ bool inside(std::int32_t x, std::int32_t y) const {
    return x >= 0 && y >= 0 && x < width_px && y < height_px;
  }
  __device__ Pixel raw(std::size_t i) const { return pixels[i]; }
  __device__ float mean(std::size_t i) const { return known_dark.mean[known_dark.uniform ? 0 : i]; }
  __device__ float over(std::size_t i) const { return static_cast<float>(pixels[i]) - mean(i); }
  /// Highest value of over(i) that is still dark.
  __device__ float dark(std::size_t i) const {
    return static_cast<float>(known_dark.limit[known_dark.uniform ? 0 : i]) - mean(i);
  }
  __device__ bool saturated(std::size_t i) const { return static_cast<float>(pixels[i]) >= saturation_grey; }
};

/// The square round (x, y): bit k of `neighbours` says that pixel k of it, row by row, is another spot's.
template <class Pixel>
struct CudaSquare {
  using Value = float;

  const SpotOptions& options;
  const CudaGrey<Pixel>& image;
  std::int32_t x, y;
  std::uint64_t neighbours;

  struct Place {
    bool own;
    std::size_t index;
  };
  __device__ Place place(std::size_t k) const {
    const auto radius = static_cast<std::int32_t>(options.radius), side = 2 * radius + 1;
    const auto column = static_cast<std::int32_t>(k % SpotBatch::kRow),
               row = static_cast<std::int32_t>(k / SpotBatch::kRow);
    const std::int32_t at_x = x + column - radius, at_y = y + row - radius;
    const bool own = image.inside(at_x, at_y) && (neighbours >> (row * side + column) & 1) == 0;
    return {own, own ? image.index(at_x, at_y) : 0};
  }
  __device__ float grey(std::size_t k) const {
    const Place at = place(k);
    return at.own ? image.over(at.index) : 0.0F;
  }
  __device__ float usable(std::size_t k) const {
    const Place at = place(k);
    return at.own && !image.saturated(at.index) ? 1.0F : 0.0F;
  }

  /// exp(middle + slope·d + bend·d²) at d = i - radius.
  struct Profile {
    __device__ Profile(std::size_t radius, float slope_, float bend_, float middle_)
        : half(static_cast<float>(radius)), slope(slope_), bend(bend_), middle(middle_) {}
    __device__ float logarithm(std::size_t i) const {
      const float at = static_cast<float>(i) - half;
      return middle + slope * at + bend * (at * at);
    }
    __device__ float value(std::size_t i) const { return exp_of(logarithm(i)); }
    float half, slope, bend, middle;
  };
};

}  // namespace rptv
