// SPDX-License-Identifier: MIT
// The threshold pass: almost every pixel is dark, so blocks are tested whole first.
#include "reconstruct/lit_pixels.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr std::size_t kBlock = 64;

std::uint16_t saturated(double grey) noexcept {
  return static_cast<std::uint16_t>(std::clamp(std::floor(grey), 0.0, 65535.0));
}

template <class Pixel>
bool any_lit(const Pixel* pixels, const std::uint16_t* limits) noexcept {
  unsigned lit = 0;
  for (std::size_t i = 0; i < kBlock; ++i) lit |= static_cast<unsigned>(pixels[i] > limits[i]);  // vectorised
  return lit != 0;
}

template <class Pixel>
std::size_t find(const Pixel* pixels, std::span<const std::uint16_t> limits, std::span<std::uint32_t> lit) noexcept {
  std::size_t count = 0;
  const auto test = [&](std::size_t i) {
    if (pixels[i] <= limits[i]) return;
    if (count < lit.size()) lit[count] = static_cast<std::uint32_t>(i);
    ++count;
  };
  std::size_t i = 0;
  for (; i + kBlock <= limits.size(); i += kBlock) {
    if (!any_lit(pixels + i, limits.data() + i)) continue;
    for (std::size_t k = i; k < i + kBlock; ++k) test(k);
  }
  for (; i < limits.size(); ++i) test(i);
  return count;
}

}  // namespace

DarkLimit::DarkLimit(const ImageShape& shape, double background, double threshold)
    : limits_(shape.pixels(), saturated(background + threshold)) {}

DarkLimit::DarkLimit(const ImageView& background, double threshold) {
  limits_.reserve(background.shape.pixels());
  for (std::size_t i = 0; i < background.shape.pixels(); ++i)
    limits_.push_back(saturated(
        (background.shape.bytes_per_pixel == 1 ? background.as_u8()[i] : background.as_u16()[i]) + threshold));
}

std::size_t find_lit_pixels(const ImageView& image, const DarkLimit& limit, std::span<std::uint32_t> lit) noexcept {
  return image.shape.bytes_per_pixel == 1 ? find(image.as_u8(), limit.limits(), lit)
                                          : find(image.as_u16(), limit.limits(), lit);
}

}  // namespace rptv
