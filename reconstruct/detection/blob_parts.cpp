// SPDX-License-Identifier: MIT
// The flood: pixels in order of grey, each joined to what it touches.
#include "reconstruct/detection/blob_parts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "reconstruct/detection/lit_maxima_mask.hpp"

namespace rptv {

BlobParts::BlobParts(const ImageShape& shape, std::size_t most_pixels, double split_sigmas, const GreyNoise& noise)
    : stride_(std::size_t{shape.width_px} + 2),
      split_sigmas_(static_cast<float>(split_sigmas)),
      noise_(noise),
      peak_at_(stride_ * (std::size_t{shape.height_px} + 2)) {
  pixels_.reserve(most_pixels), sorted_.reserve(most_pixels), peaks_.reserve(most_pixels);
}

// One pass of a radix sort, brightest first; equal ones stay in order.
void BlobParts::sort_by_byte(unsigned shift) noexcept {
  std::array<std::uint32_t, 256> begin{};
  const auto key = [shift](const PartPixel& p) { return 255U - (p.grey >> shift & 255U); };
  for (const auto& p : pixels_) ++begin[key(p)];
  std::uint32_t sum = 0;
  for (auto& b : begin) sum += std::exchange(b, sum);
  sorted_.resize(pixels_.size());
  for (const auto& p : pixels_) sorted_[begin[key(p)]++] = p;
  pixels_.swap(sorted_);
}

std::uint32_t BlobParts::root_of(std::uint32_t peak) noexcept {
  while (peaks_[peak].parent != peak) {
    peaks_[peak].parent = peaks_[peaks_[peak].parent].parent;
    peak = peaks_[peak].parent;
  }
  return peak;
}

// Earlier peaks are higher, or as high and first in raster order. A pixel belongs to the first that it touches; the
// others end there when they have not risen by more than noise.
void BlobParts::flood() noexcept {
  peaks_.clear();
  for (auto& p : pixels_) {
    const std::size_t place = place_of(p);
    std::array<std::uint32_t, 8> touched;
    std::size_t count = 0;
    for (const std::size_t row : {place - stride_, place, place + stride_})
      for (const std::size_t near : {row - 1, row, row + 1})
        if (peak_at_[near] != 0) touched[count++] = root_of(peak_at_[near] - 1);
    if (count == 0) {
      p.part = static_cast<std::uint32_t>(peaks_.size());
      const float depth = split_sigmas_ * std::sqrt(noise_.variance(p.over_background));
      peaks_.push_back({p.grey, depth, p.part, 0});
    } else {
      p.part = *std::min_element(touched.begin(), touched.begin() + static_cast<std::ptrdiff_t>(count));
      for (std::size_t k = 0; k < count; ++k)
        if (Peak& other = peaks_[touched[k]]; static_cast<float>(other.grey - p.grey) <= other.depth)
          other.parent = p.part;
    }
    peak_at_[place] = p.part + 1;
  }
}

std::uint32_t BlobParts::number_parts() noexcept {
  std::uint32_t parts = 0;
  for (std::uint32_t i = 0; i < peaks_.size(); ++i)  // a peak comes after the one that took it
    peaks_[i].part = peaks_[i].parent == i ? parts++ : peaks_[root_of(i)].part;
  for (auto& p : pixels_) {
    peak_at_[place_of(p)] = 0;
    p.part = peaks_[p.part].part;
  }
  return parts;
}

template <class Pixel>
std::uint32_t BlobParts::take_apart(const GreyOverBackground<Pixel>& grey, std::span<const LitRun> component) noexcept {
  pixels_.clear();
  std::size_t maxima = 0;
  for (const LitRun& run : component)
    for (std::uint32_t x = run.first_x; x < run.end_x; ++x) {
      const std::size_t i = grey.index(static_cast<std::int32_t>(x), static_cast<std::int32_t>(run.y));
      pixels_.push_back({x, run.y, grey.over(i), grey.over_limit(i), grey.raw(i), 0});
      maxima += is_maximum(grey.pixels() + i, grey.width());
    }
  if (maxima == 1) return 1;  // nothing to take apart
  sort_by_byte(0);
  if (sizeof(Pixel) == 2) sort_by_byte(8);
  flood();
  return number_parts();
}

template std::uint32_t BlobParts::take_apart(const GreyOverBackground<std::uint8_t>&, std::span<const LitRun>) noexcept;
template std::uint32_t BlobParts::take_apart(const GreyOverBackground<std::uint16_t>&,
                                             std::span<const LitRun>) noexcept;

}  // namespace rptv
