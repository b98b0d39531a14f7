// SPDX-License-Identifier: MIT
// A component of lit pixels taken apart into the particle images that overlap in it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "reconstruct/detection/grey_over_background.hpp"
#include "reconstruct/detection/lit_runs.hpp"

namespace rptv {

/// A lit pixel and the part of its component that it belongs to.
struct PartPixel {
  std::uint32_t x, y;
  float over_background, over_limit;  ///< grey values; over_limit is whole and at least 1
  std::uint16_t grey;                 ///< raw
  std::uint32_t part;
};

/// Floods a component from its brightest pixel down. A maximum is a part of its own when the grey falls by more than
/// `split_sigmas` of its noise before it meets a higher one (its persistence: Edelsbrunner, Letscher, Zomorodian 2002);
/// otherwise it is noise on the other. All memory is taken by the constructor. One thread.
class BlobParts {
 public:
  /// For components of up to `most_pixels` in images of that shape.
  BlobParts(const ImageShape& shape, std::size_t most_pixels, double split_sigmas, const GreyNoise& noise);

  /// Returns how many parts there are; pixels() then has all pixels of the component, which does not touch the border.
  template <class Pixel>
  std::uint32_t take_apart(const GreyOverBackground<Pixel>& grey, std::span<const LitRun> component) noexcept;
  std::span<const PartPixel> pixels() const noexcept { return pixels_; }

 private:
  struct Peak {
    std::uint16_t grey;
    float depth;           // down to which a higher one that it meets takes it
    std::uint32_t parent;  // the peak that took it, or itself
    std::uint32_t part;
  };

  void sort_by_byte(unsigned shift) noexcept;
  std::uint32_t root_of(std::uint32_t peak) noexcept;
  void flood() noexcept;
  std::uint32_t number_parts() noexcept;
  std::size_t place_of(const PartPixel& p) const noexcept { return (p.y + 1) * stride_ + p.x + 1; }

  const std::size_t stride_;
  const float split_sigmas_;
  const GreyNoise noise_;
  std::vector<PartPixel> pixels_, sorted_;
  std::vector<Peak> peaks_;
  std::vector<std::uint32_t> peak_at_;  // 1 + peak of each pixel, with a border around the image; 0: not flooded
};

}  // namespace rptv
