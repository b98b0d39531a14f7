// SPDX-License-Identifier: MIT
// Crowded spots that are added, those that turn out to be none, and what errors all have together.
#include <algorithm>
#include <cmath>

#include "reconstruct/detection/spot_overlaps.hpp"

namespace rptv {

namespace {

constexpr float kLeastShare = 0.12F;  // of a spot's peak that another one beside it has: optics leave less

double distance(const FittedSpot& a, const FittedSpot& b) noexcept {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}

}  // namespace

// Where the middle of 3x3 pixels round a spot has more light than the models by more than noise and than the threshold.
template <class Pixel>
std::size_t SpotOverlaps::find_hidden(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept {
  const std::int32_t reach = static_cast<std::int32_t>(options_.radius) + kSearchBeyond;
  const std::size_t known = spots.size();
  for (const FittedSpot& spot : spots)
    if (spot.modelled) model_->add(spot);
  for (const std::uint32_t i : crowded_) {
    if (spots[i].wide) continue;
    const auto [middle_x, middle_y] = spots[i].middle();
    FittedSpot best;
    float least = std::max(faintest_, kLeastShare * spots[i].peak);
    for (std::int32_t y = std::max(middle_y - reach, 1); y <= std::min(middle_y + reach, grey.height() - 2); ++y)
      for (std::int32_t x = std::max(middle_x - reach, 1); x <= std::min(middle_x + reach, grey.width() - 2); ++x) {
        float left = 0, variance = 0;
        bool saturated = false;
        for (std::int32_t dy = -1; dy <= 1; ++dy)
          for (std::int32_t dx = -1; dx <= 1; ++dx) {
            const std::size_t pixel = grey.index(x + dx, y + dy);
            left += grey.over(pixel) - model_->at(pixel), variance += noise_.variance(grey.over(pixel));
            saturated |= grey.saturated(pixel);
          }
        if (saturated || left / 9 <= least || left <= split_sigmas_ * std::sqrt(variance)) continue;
        best = {
            {x, y}, static_cast<double>(x), static_cast<double>(y), 1, 0, 9, left / 9, spots[i].bend, 0, 0, -1e9F, true,
            true};
        least = best.peak;
      }
    const auto is_near = [&best](const FittedSpot& other) { return distance(best, other) < 1; };
    if (best.peak == 0 || spots.size() == spots.capacity()) continue;
    if (std::any_of(spots.begin() + static_cast<std::ptrdiff_t>(known), spots.end(), is_near)) continue;
    if (options_.bend_weight > 0) best.bend = options_.expected_bend;
    model_->add(best);
    spots.push_back(best);
  }
  for (const FittedSpot& spot : spots)
    if (spot.modelled) model_->clear(spot);
  for (std::size_t i = known; i < spots.size(); ++i) crowded_.push_back(static_cast<std::uint32_t>(i));
  return spots.size() - known;
}

// Calls visit(a, b) for crowded spots whose rows and columns differ by less than `reach`.
template <class Visit>
void SpotOverlaps::each_crowded_pair(std::vector<FittedSpot>& spots, double reach, const Visit& visit) noexcept {
  std::sort(crowded_.begin(), crowded_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return spots[a].y_px < spots[b].y_px || (spots[a].y_px == spots[b].y_px && a < b);
  });
  for (std::size_t i = 0; i < crowded_.size(); ++i)
    for (std::size_t k = i + 1; k < crowded_.size(); ++k) {
      FittedSpot &a = spots[crowded_[i]], &b = spots[crowded_[k]];
      if (b.y_px - a.y_px >= reach) break;
      if (std::abs(a.x_px - b.x_px) < reach) visit(a, b);
    }
}

// Those that have become dark, and the fainter of two that have become one. Their peak is 0 then.
void SpotOverlaps::remove_false(std::vector<FittedSpot>& spots) noexcept {
  for (const std::uint32_t i : crowded_)
    if (spots[i].peak < faintest_) spots[i].peak = 0;
  each_crowded_pair(spots, 1, [&](FittedSpot& a, FittedSpot& b) {
    if (a.peak > 0 && b.peak > 0) (a.peak < b.peak ? a : b).peak = 0;
  });
  std::erase_if(crowded_, [&](std::uint32_t i) { return spots[i].peak == 0; });
}

// Each was fitted as if the others were known. What it shares with a neighbour at distance d is the correlation of
// their derivatives, e^(-u)·(1 - 2u) along the line between them and e^(-u) across it, and e^(-u)·√2u with the
// neighbour's light, where u = d²/4σ²; its variance is larger by 1/(1 - the sum of their squares).
void SpotOverlaps::widen_errors(std::vector<FittedSpot>& spots) noexcept {
  for (const std::uint32_t i : crowded_) spots[i].shared = {0, 0};
  each_crowded_pair(spots, seen_px_, [](FittedSpot& a, FittedSpot& b) {
    const double d = distance(a, b), u = -d * d * static_cast<double>(a.bend + b.bend) / 4, both = std::exp(-2 * u);
    for (FittedSpot* spot : {&a, &b}) {
      spot->shared[0] += both * ((1 - 2 * u) * (1 - 2 * u) + 2 * u);
      spot->shared[1] += both;
    }
  });
  constexpr double kMostShared = 0.98;
  for (const std::uint32_t i : crowded_) {
    const auto [along, across] = spots[i].shared;
    const double factor = 0.5 / (1 - std::min(along, kMostShared)) + 0.5 / (1 - std::min(across, kMostShared));
    spots[i].variance_px2 *= static_cast<float>(factor);
  }
}

template std::size_t SpotOverlaps::find_hidden(const GreyOverBackground<std::uint8_t>&,
                                               std::vector<FittedSpot>&) noexcept;
template std::size_t SpotOverlaps::find_hidden(const GreyOverBackground<std::uint16_t>&,
                                               std::vector<FittedSpot>&) noexcept;

}  // namespace rptv
