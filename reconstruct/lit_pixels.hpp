// SPDX-License-Identifier: MIT
// Which pixels particles have lit: the threshold above the background, before eq. (5).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/huge_pages.hpp"
#include "core/image.hpp"
#include "core/instruction_set.hpp"

namespace rptv {

/// Highest grey value of each pixel that is still dark: background + threshold, saturated. One writer or any readers.
class DarkLimit {
 public:
  /// The same limit for every pixel.
  DarkLimit(const ImageShape& shape, double background, double threshold);
  /// From an image without particles, 8 or 16 bit.
  DarkLimit(const ImageView& background, double threshold);

  /// New limits: mean + the larger of share·`threshold` and `sigmas` times the pixel's noise, all in grey values. Sizes
  /// equal size(); empty, `sigma` is 0 and `share` 1 everywhere.
  void follow(std::span<const float> mean, std::span<const float> sigma, std::span<const float> share, double threshold,
              double sigmas) noexcept;

  std::size_t size() const noexcept { return limits_.size(); }
  std::span<const std::uint16_t> limits() const noexcept { return limits_; }
  /// All limits are equal: whoever reads the first ones knows all.
  bool uniform() const noexcept { return uniform_; }

 private:
  std::vector<std::uint16_t, HugePages<std::uint16_t>> limits_;
  bool uniform_;
};

/// Writes the indices (row·width + column) of pixels above their limit into `lit`, in raster order, and returns how
/// many there are: more than lit.size() means that the last ones were left out. `image` has limit.size() pixels.
std::size_t find_lit_pixels(const ImageView& image, const DarkLimit& limit, std::span<std::uint32_t> lit,
                            InstructionSet set = best_instruction_set()) noexcept;

}  // namespace rptv
