// SPDX-License-Identifier: MIT
// The threshold pass: 64 pixels are compared at once into a mask, and almost every mask is empty.
#include "reconstruct/lit_pixels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "reconstruct/lit_mask.hpp"

namespace rptv {

namespace {

std::uint16_t saturated(double grey) noexcept {
  return static_cast<std::uint16_t>(std::clamp(std::floor(grey), 0.0, 65535.0));
}

// Compiled once per instruction set: `Mask` gives the bits of 64 pixels above their limits.
template <class Mask, class Pixel>
[[gnu::always_inline]] inline std::size_t find(const Pixel* pixels, const DarkLimit& limit,
                                               std::span<std::uint32_t> lit) noexcept {
  const std::span<const std::uint16_t> limits = limit.limits();
  const std::size_t step = limit.uniform() ? 0 : 1;  // the same 64 limits again: half of the memory traffic
  std::size_t count = 0;
  std::size_t i = 0;
  for (; i + 64 <= limits.size(); i += 64) {
    std::uint64_t mask = Mask::above(pixels + i, limits.data() + step * i);
    if (mask == 0) continue;
    if (count + 64 > lit.size()) break;
    for (; mask != 0; mask &= mask - 1)
      lit[count++] = static_cast<std::uint32_t>(i) + static_cast<std::uint32_t>(std::countr_zero(mask));
  }
  for (; i < limits.size(); ++i) {  // the last pixels, or those for which there may be no room
    if (pixels[i] <= limits[i]) continue;
    if (count < lit.size()) lit[count] = static_cast<std::uint32_t>(i);
    ++count;
  }
  return count;
}

#define RPTV_FIND(SET, TARGET, MASK)                                                  \
  TARGET std::size_t find_##SET(const ImageView& image, const DarkLimit& limit,       \
                                std::span<std::uint32_t> lit) noexcept {              \
    return image.shape.bytes_per_pixel == 1 ? find<MASK>(image.as_u8(), limit, lit)   \
                                            : find<MASK>(image.as_u16(), limit, lit); \
  }

RPTV_FIND(portable, , LitMask)
#if defined(__x86_64__)
RPTV_FIND(avx2, RPTV_LIT_AVX2, LitMaskAvx2)
RPTV_FIND(avx512, RPTV_LIT_AVX512, LitMaskAvx512)
#endif

}  // namespace

DarkLimit::DarkLimit(const ImageShape& shape, double background, double threshold)
    : limits_(shape.pixels(), saturated(background + threshold)), uniform_(true) {}

DarkLimit::DarkLimit(const ImageView& background, double threshold) : uniform_(false) {
  limits_.reserve(background.shape.pixels());
  for (std::size_t i = 0; i < background.shape.pixels(); ++i)
    limits_.push_back(saturated(
        (background.shape.bytes_per_pixel == 1 ? background.as_u8()[i] : background.as_u16()[i]) + threshold));
}

void DarkLimit::follow(std::span<const float> mean, std::span<const float> sigma, std::span<const float> share,
                       double threshold, double sigmas) noexcept {
  const auto least = static_cast<float>(threshold), per_sigma = static_cast<float>(sigmas);
  uniform_ = false;
  for (std::size_t i = 0; i < limits_.size(); ++i) {
    const float signal = share.empty() ? least : share[i] * least;
    const float noise = sigma.empty() ? 0 : per_sigma * sigma[i];
    limits_[i] = static_cast<std::uint16_t>(std::clamp(std::floor(mean[i] + std::max(signal, noise)), 0.0F, 65535.0F));
  }
}

std::size_t find_lit_pixels(const ImageView& image, const DarkLimit& limit, std::span<std::uint32_t> lit,
                            InstructionSet set) noexcept {
#if defined(__x86_64__)
  if (set == InstructionSet::avx512) return find_avx512(image, limit, lit);
  if (set == InstructionSet::avx2) return find_avx2(image, limit, lit);
#endif
  static_cast<void>(set);
  return find_portable(image, limit, lit);
}

}  // namespace rptv
