// SPDX-License-Identifier: MIT
// Sweeps over crowded spots, and the light that they leave.
#include "reconstruct/spot_overlaps.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr std::size_t kFewestWidths = 12;  // for a median that means something
constexpr float kWidthSpread = 0.25F;      // of bend, over itself: widths within an eighth
constexpr float kMostMisfit = 4;           // of a spot that is alone
constexpr float kLeastShare = 0.12F;       // of a spot's peak that another one beside it has: optics leave less
constexpr int kSearches = 2;

double distance(const FittedSpot& a, const FittedSpot& b) noexcept {
  return std::hypot(a.x_px - b.x_px, a.y_px - b.y_px);
}

PixelIndex middle_of(const FittedSpot& spot) noexcept {
  return {static_cast<std::int32_t>(std::lround(spot.x_px)), static_cast<std::int32_t>(std::lround(spot.y_px))};
}

}  // namespace

SpotOverlaps::SpotOverlaps(const DetectorSettings& settings, const ImageShape& shape, const SpotOptions& options,
                           std::size_t most_spots, InstructionSet set)
    : set_(set),
      sweeps_(settings.overlap_sweeps),
      split_sigmas_(static_cast<float>(settings.split_sigmas)),
      faintest_(static_cast<float>(std::max(settings.threshold, settings.threshold_sigmas * settings.noise_grey))),
      noise_(GreyNoise::of(settings.noise_grey, settings.electrons_per_grey)),
      options_(options),
      model_(shape) {
  for (auto* list : {&crowded_, &pending_, &deferred_}) list->reserve(most_spots);
  bends_.reserve(most_spots);
}

void SpotOverlaps::expect_width(const std::vector<FittedSpot>& spots) noexcept {
  bends_.clear();
  for (const auto& spot : spots)
    if (spot.bend < 0) bends_.push_back(spot.bend);
  options_.bend_weight = 0;
  if (bends_.size() < kFewestWidths) return;
  const auto middle = bends_.begin() + static_cast<std::ptrdiff_t>(bends_.size() / 2);
  std::nth_element(bends_.begin(), middle, bends_.end());
  options_.expected_bend = *middle;
  options_.bend_weight = 1 / (kWidthSpread * kWidthSpread * *middle * *middle);
}

// The square of a spot without the light of others. Their shot noise stays: pixels weigh less for it.
template <class Pixel>
void SpotOverlaps::fill(const GreyOverBackground<Pixel>& grey, const FittedSpot& spot, std::size_t lane) noexcept {
  const auto radius = static_cast<std::int32_t>(options_.radius);
  const auto [middle_x, middle_y] = middle_of(spot);
  std::array<float, 2 * SpotBatch::kMostRadius + 1> along_x{};
  for (std::int32_t dx = -radius; dx <= radius; ++dx) {
    const auto off = static_cast<float>(middle_x + dx - spot.x_px);
    along_x[static_cast<std::size_t>(dx + radius)] = std::exp(spot.bend * off * off);
  }
  std::size_t k = 0;
  for (std::int32_t y = middle_y - radius; y <= middle_y + radius; ++y) {
    const auto off = static_cast<float>(y - spot.y_px);
    const float along_y = spot.peak * std::exp(spot.bend * off * off);
    for (std::int32_t dx = -radius; dx <= radius; ++dx, ++k) {
      const std::int32_t x = middle_x + dx;
      batch_.grey[k][lane] = batch_.usable[k][lane] = 0;
      if (x < 0 || y < 0 || x >= grey.width() || y >= grey.height()) continue;
      const std::size_t i = grey.index(x, y);
      const float own = along_x[static_cast<std::size_t>(dx + radius)] * along_y, all = std::max(model_.at(i), own);
      batch_.grey[k][lane] = grey.over(i) - (all - own);
      if (!grey.saturated(i)) batch_.usable[k][lane] = noise_.variance(own) / noise_.variance(all);
    }
  }
}

// Takes over the fits that stay a peak and do not run away.
void SpotOverlaps::fit_batch(std::vector<FittedSpot>& spots) noexcept {
  if (batch_size_ == 0) return;
  find_spot_centres(batch_, options_, centres_, set_);
  for (std::size_t lane = 0; lane < batch_size_; ++lane) {
    FittedSpot& spot = spots[in_batch_[lane]];
    const auto [middle_x, middle_y] = middle_of(spot);
    const double x = middle_x + static_cast<double>(centres_.x[lane]);
    const double y = middle_y + static_cast<double>(centres_.y[lane]);
    spot.misfit = centres_.misfit[lane];
    const bool runs_away =
        std::abs(x - spot.start.x) > ModelImage::kMostMove || std::abs(y - spot.start.y) > ModelImage::kMostMove;
    if (centres_.bend[lane] == 0 || runs_away) continue;
    model_.take_away(spot);
    spot.x_px = x, spot.y_px = y;
    spot.variance_px2 = centres_.variance[lane], spot.grey = centres_.grey[lane];
    spot.peak = centres_.peak[lane], spot.bend = centres_.bend[lane];
    model_.add(spot);
  }
  batch_size_ = 0;
}

// Spots of one batch do not see each other's change, so they must not be near; those that are wait for the next round.
template <class Pixel>
void SpotOverlaps::sweep(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept {
  const double apart = crowd_reach(static_cast<std::int32_t>(options_.radius));
  pending_.assign(crowded_.begin(), crowded_.end());
  while (!pending_.empty()) {
    deferred_.clear();
    for (const std::uint32_t i : pending_) {
      const bool near = std::any_of(in_batch_.begin(), in_batch_.begin() + static_cast<std::ptrdiff_t>(batch_size_),
                                    [&](std::uint32_t other) {
                                      return std::abs(spots[i].x_px - spots[other].x_px) < apart &&
                                             std::abs(spots[i].y_px - spots[other].y_px) < apart;
                                    });
      if (near) {
        deferred_.push_back(i);
        continue;
      }
      fill(grey, spots[i], batch_size_);
      in_batch_[batch_size_++] = i;
      if (batch_size_ == SpotBatch::kSpots) fit_batch(spots);
    }
    fit_batch(spots);
    pending_.swap(deferred_);
  }
}

// Where the middle of 3x3 pixels round a spot has more light than the models by more than noise and than the threshold.
template <class Pixel>
std::size_t SpotOverlaps::find_hidden(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept {
  const std::int32_t reach = static_cast<std::int32_t>(options_.radius) + 2;
  const std::size_t known = spots.size();
  for (const std::uint32_t i : crowded_) {
    const auto [middle_x, middle_y] = middle_of(spots[i]);
    FittedSpot best;
    float least = std::max(faintest_ / 2, kLeastShare * spots[i].peak);
    for (std::int32_t y = std::max(middle_y - reach, 1); y <= std::min(middle_y + reach, grey.height() - 2); ++y)
      for (std::int32_t x = std::max(middle_x - reach, 1); x <= std::min(middle_x + reach, grey.width() - 2); ++x) {
        float left = 0, variance = 0;
        bool saturated = false;
        for (std::int32_t dy = -1; dy <= 1; ++dy)
          for (std::int32_t dx = -1; dx <= 1; ++dx) {
            const std::size_t pixel = grey.index(x + dx, y + dy);
            left += grey.over(pixel) - model_.at(pixel), variance += noise_.variance(grey.over(pixel));
            saturated |= grey.saturated(pixel);
          }
        if (saturated || left / 9 <= least || left <= split_sigmas_ * std::sqrt(variance)) continue;
        best = {{x, y}, static_cast<double>(x), static_cast<double>(y), 1, 0, 9, left / 9, spots[i].bend, 0, true};
        least = best.peak;
      }
    const auto is_near = [&best](const FittedSpot& other) { return distance(best, other) < 1; };
    if (best.peak == 0 || spots.size() == spots.capacity()) continue;
    if (std::any_of(spots.begin() + static_cast<std::ptrdiff_t>(known), spots.end(), is_near)) continue;
    if (options_.bend_weight > 0) best.bend = options_.expected_bend;
    model_.add(best);
    spots.push_back(best);
  }
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
  const auto remove = [this](FittedSpot& spot) {
    model_.take_away(spot);
    spot.peak = 0;
  };
  for (const std::uint32_t i : crowded_)
    if (spots[i].peak < faintest_) remove(spots[i]);
  each_crowded_pair(spots, 1, [&](FittedSpot& a, FittedSpot& b) {
    if (a.peak > 0 && b.peak > 0) remove(a.peak < b.peak ? a : b);
  });
  std::erase_if(crowded_, [&](std::uint32_t i) { return spots[i].peak == 0; });
}

// Each was fitted as if the others were known. What it shares with a neighbour at distance d is the correlation of
// their derivatives, e^(-u)·(1 - 2u) along the line between them and e^(-u) across it, and e^(-u)·√2u with the
// neighbour's light, where u = d²/4σ²; its variance is larger by 1/(1 - the sum of their squares).
void SpotOverlaps::widen_errors(std::vector<FittedSpot>& spots) noexcept {
  for (const std::uint32_t i : crowded_) spots[i].shared = {0, 0};
  each_crowded_pair(spots, crowd_reach(static_cast<std::int32_t>(options_.radius)), [](FittedSpot& a, FittedSpot& b) {
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

template <class Pixel>
void SpotOverlaps::untangle(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept {
  crowded_.clear();
  for (std::uint32_t i = 0; i < spots.size(); ++i) {
    FittedSpot& spot = spots[i];
    spot.crowded = spot.bend < 0 && (spot.crowded || spot.misfit > kMostMisfit);
    if (!spot.crowded) continue;
    model_.add(spot);
    crowded_.push_back(i);
  }
  if (crowded_.empty()) return;
  expect_width(spots);
  for (int search = 0;; ++search) {
    for (std::int64_t k = 0; k < sweeps_; ++k) sweep(grey, spots);
    remove_false(spots);
    if (search == kSearches || find_hidden(grey, spots) == 0) break;
  }
  widen_errors(spots);
  for (const FittedSpot& spot : spots)
    if (spot.crowded) model_.clear(spot);
  std::erase_if(spots, [](const FittedSpot& spot) { return spot.crowded && spot.peak == 0; });
}

template void SpotOverlaps::untangle(const GreyOverBackground<std::uint8_t>&, std::vector<FittedSpot>&) noexcept;
template void SpotOverlaps::untangle(const GreyOverBackground<std::uint16_t>&, std::vector<FittedSpot>&) noexcept;

}  // namespace rptv
