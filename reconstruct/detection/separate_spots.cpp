// SPDX-License-Identifier: MIT
// From maxima to spots: noise and plateaus merged, pixels between neighbours shared out.
#include "reconstruct/detection/separate_spots.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruct/detection/near_grey_kernel.hpp"
#include "reconstruct/detection/near_pairs.hpp"

namespace rptv {

namespace {

constexpr std::size_t kPairsPerMaximum = 8;  // beyond them neighbours keep the pixels between them to themselves

}  // namespace

SeparateSpots::SeparateSpots(const DetectorSettings& settings, std::size_t most_maxima, InstructionSet set)
    : radius_(static_cast<std::int32_t>(settings.radius_px)),
      reach_(settings.overlap_sweeps > 0 ? crowd_reach(radius_) : merge_reach(radius_)),
      split_sigmas_(static_cast<float>(settings.split_sigmas)),
      noise_(GreyNoise::of(settings.noise_grey, settings.electrons_per_grey)),
      near_columns_(near_columns(set)) {
  spots_.reserve(most_maxima);
  pairs_.reserve(kPairsPerMaximum * most_maxima);
}

template <class Pixel>
std::span<const Spot> SeparateSpots::separate(const GreyOverBackground<Pixel>& grey,
                                              std::span<const PixelIndex> maxima) noexcept {
  place_squares(grey, maxima);
  drop_noise(grey, maxima);
  share_pixels();
  return spots_;
}

template <class Pixel>
void SeparateSpots::place_squares(const GreyOverBackground<Pixel>& grey, std::span<const PixelIndex> maxima) noexcept {
  spots_.clear();
  for (const PixelIndex maximum : maxima) {
    Spot spot;
    spot.middle = maximum;
    if (grey.saturated(grey.index(maximum.x, maximum.y))) {
      const Plateau plateau = plateau_of(grey, maximum.x, maximum.y);
      spot.plateau_x = plateau.x, spot.plateau_y = plateau.y, spot.plateau_rows = plateau.rows;
      spot.middle = {static_cast<std::int32_t>(std::lround(plateau.x)),
                     static_cast<std::int32_t>(std::lround(plateau.y))};
    }
    spots_.push_back(spot);
  }
}

// Of two maxima the lower one is noise on the other's image, or one more corner of its plateau, when the grey between
// them falls by no more than noise does.
template <class Pixel>
void SeparateSpots::drop_noise(const GreyOverBackground<Pixel>& grey, std::span<const PixelIndex> maxima) noexcept {
  const std::int32_t mergeable = merge_reach(radius_);
  pairs_.clear();
  each_near_pair(maxima, reach_, near_columns_, [&](std::size_t i, std::size_t j) {
    if (pairs_.size() < pairs_.capacity()) pairs_.push_back({i, j});
    if (maxima[j].y - maxima[i].y > mergeable || std::abs(maxima[j].x - maxima[i].x) > mergeable) return;
    const std::size_t first = grey.index(maxima[i].x, maxima[i].y), second = grey.index(maxima[j].x, maxima[j].y);
    const bool first_is_lower = grey.raw(first) < grey.raw(second);
    const std::size_t lower = first_is_lower ? first : second;
    const float noise = std::sqrt(noise_.variance(grey.over(lower)));
    if (least_between(grey, maxima[i].x, maxima[i].y, maxima[j].x, maxima[j].y) >=
        static_cast<float>(grey.raw(lower)) - split_sigmas_ * noise)
      spots_[first_is_lower ? i : j].merged = true;
  });
}

// A pixel belongs to the nearest maximum; halfway between, to neither.
void SeparateSpots::share_pixels() noexcept {
  const auto yield_to = [this](Spot& spot, PixelIndex other) {
    const std::int32_t ox = other.x - spot.middle.x, oy = other.y - spot.middle.y;
    if (2 * radius_ * (std::abs(ox) + std::abs(oy)) < ox * ox + oy * oy) return;  // not even a corner of the square
    std::uint64_t bit = 1;
    for (std::int32_t dy = -radius_; dy <= radius_; ++dy)
      for (std::int32_t dx = -radius_; dx <= radius_; ++dx, bit <<= 1)
        if (2 * (dx * ox + dy * oy) >= ox * ox + oy * oy) spot.neighbours |= bit;
  };
  for (const auto& [i, j] : pairs_) {
    if (spots_[i].merged || spots_[j].merged) continue;
    const std::int32_t dx = spots_[i].middle.x - spots_[j].middle.x, dy = spots_[i].middle.y - spots_[j].middle.y;
    for (Spot* spot : {&spots_[i], &spots_[j]})
      spot->nearest_px2 = std::min(spot->nearest_px2, static_cast<float>(dx * dx + dy * dy));
    yield_to(spots_[i], spots_[j].middle);
    yield_to(spots_[j], spots_[i].middle);
  }
}

template std::span<const Spot> SeparateSpots::separate(const GreyOverBackground<std::uint8_t>&,
                                                       std::span<const PixelIndex>) noexcept;
template std::span<const Spot> SeparateSpots::separate(const GreyOverBackground<std::uint16_t>&,
                                                       std::span<const PixelIndex>) noexcept;

}  // namespace rptv
