// SPDX-License-Identifier: MIT
// What is left of one camera's image when the images of the known particles are taken away, with a weight per pixel.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "core/instruction_set.hpp"
#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/detection/grey_over_background.hpp"
#include "reconstruct/multi_view/view_spot.hpp"

namespace rptv {

/// Rows of pixels with a margin round the image.
struct PaddedRaster {
  static constexpr int kMargin_px = 32;
  int width_px, height_px;
  std::size_t stride;

  explicit PaddedRaster(const ImageShape& shape) noexcept
      : width_px(static_cast<int>(shape.width_px)),
        height_px(static_cast<int>(shape.height_px)),
        stride(shape.width_px + 2 * std::size_t{kMargin_px}) {}
  std::size_t size() const noexcept { return stride * (static_cast<std::size_t>(height_px) + 2 * kMargin_px); }
  std::size_t index(int column, int row) const noexcept {
    return static_cast<std::size_t>(row + kMargin_px) * stride + static_cast<std::size_t>(column + kMargin_px);
  }
  /// Some of the spot's light may be in the image, and all of it is in the raster. False for what is not a number.
  bool near(const ViewSpot& spot) const noexcept {
    constexpr float kFar_px = 12;
    return spot.u_px > -kFar_px && spot.v_px > -kFar_px && spot.u_px < static_cast<float>(width_px) + kFar_px &&
           spot.v_px < static_cast<float>(height_px) + kFar_px;
  }
};

/// All memory is taken by the constructor. Round the image is a dark margin of weight 0, so that spots may reach over
/// its border. One thread changes it; sums() may be called by several at once meanwhile nobody does. Every instruction
/// set gives the same bits.
class ResidualView {
 public:
  /// `saturation_grey`: from here a pixel tells nothing; 0: the highest of its type.
  ResidualView(const ImageShape& shape, const GreyNoise& noise, double saturation_grey,
               InstructionSet set = best_instruction_set());

  /// Takes an image of shape's size over its background; the residual is all of it. A pixel's weight is one over the
  /// variance that its grey value has, 0 where it is saturated.
  void load(const ImageView& image, const DarkPixels& dark) noexcept;
  /// An image without light, of which no pixel counts.
  void load_nothing() noexcept;

  /// The residual is all of the image again.
  void restore() noexcept;
  /// Takes spots away from the residual; those that are not near() are left out.
  void subtract(std::span<const ViewSpot> spots) noexcept;
  bool near(const ViewSpot& spot) const noexcept { return raster_.near(spot); }
  /// Of a spot that near() allows.
  SpotSums sums(const ViewSpot& spot) const noexcept;

  int width_px() const noexcept { return raster_.width_px; }
  int height_px() const noexcept { return raster_.height_px; }
  /// From pixel (0, row) on; rows -1 and height_px(), columns -1 and width_px() are in the margin.
  const float* residual_row(int row) const noexcept { return residual_.data() + raster_.index(0, row); }
  const float* weight_row(int row) const noexcept { return weight_.data() + raster_.index(0, row); }

 private:
  template <class Pixel>
  void load_as(const ImageView& image, const DarkPixels& dark) noexcept;

  PaddedRaster raster_;
  GreyNoise noise_;
  double saturation_grey_;
  InstructionSet set_;
  std::vector<float> grey_, residual_, weight_;
};

}  // namespace rptv
