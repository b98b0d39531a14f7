// SPDX-License-Identifier: MIT
// Sweeps over crowded spots, and the light that they leave.
#include "reconstruct/detection/spot_overlaps.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruct/detection/spot_square.hpp"

namespace rptv {

namespace {

constexpr std::size_t kFewestWidths = 12;  // for a median that means something
constexpr float kWidthSpread = 0.25F;      // of bend, over itself: widths within an eighth
constexpr float kMostMisfit = 2.5F;        // of a spot that is alone
constexpr float kWidest = 0.3F;            // bend, of the expected one: what is wider is no pair but another thing
constexpr int kSearches = 3;               // for hidden ones
constexpr float kSigmasSeen = 3.2F;        // where a Gaussian has fallen to half a percent
constexpr float kWidestSigma = 2.5F;       // px, where the frame does not tell
constexpr float kSettled = 0.1F;           // change of others' light, in noise of the square, that no fit is made for

}  // namespace

SpotOverlaps::SpotOverlaps(const DetectorSettings& settings, const ImageShape& shape, const SpotOptions& options,
                           std::size_t most_spots, InstructionSet set)
    : set_(set),
      sweeps_(settings.overlap_sweeps),
      find_hidden_(settings.find_hidden),
      most_crowded_(static_cast<std::size_t>(settings.max_overlapping)),
      split_sigmas_(static_cast<float>(settings.split_sigmas)),
      faintest_(static_cast<float>(std::max(settings.threshold, settings.threshold_sigmas * settings.noise_grey))),
      noise_(GreyNoise::of(settings.noise_grey, settings.electrons_per_grey)),
      options_(options),
      neighbours_(most_spots, most_crowded_, set) {
  if (find_hidden_) model_.emplace(shape);
  for (auto* list : {&crowded_, &pending_, &deferred_}) list->reserve(most_spots);
  bends_.reserve(most_spots);
}

void SpotOverlaps::expect_width(const std::vector<FittedSpot>& spots) noexcept {
  bends_.clear();
  for (const auto& spot : spots)
    if (spot.bend < 0) bends_.push_back(spot.bend);
  options_.bend_weight = options_.expected_bend = 0;
  if (bends_.size() < kFewestWidths) return;
  const auto middle = bends_.begin() + static_cast<std::ptrdiff_t>(bends_.size() / 2);
  std::nth_element(bends_.begin(), middle, bends_.end());
  options_.expected_bend = *middle;
  options_.bend_weight = 1 / (kWidthSpread * kWidthSpread * *middle * *middle);
}

// The square of a spot without the light of others, into the next lane; false when that has hardly changed since the
// last fit. Their shot noise stays: pixels weigh less for it.
template <class Pixel>
bool SpotOverlaps::fill(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots,
                        std::uint32_t i) noexcept {
  const auto radius = static_cast<std::int32_t>(options_.radius);
  light_crowded_square(spots, i, neighbours_.of(i), radius, noise_, square_, set_);
  const float change = square_.others_sum - spots[i].others;
  if (change * change < kSettled * kSettled * square_.variance_sum) return false;
  spots[i].others = square_.others_sum;
  SpotBatch::Square &light = batch_.grey[batch_size_], &usable = batch_.usable[batch_size_];
  const auto [middle_x, middle_y] = spots[i].middle();
  const std::size_t used = (2 * options_.radius + 1) * SpotBatch::kRow;
  if (has_whole_rows(grey, {middle_x, middle_y}, radius) &&
      copy_square(grey, {middle_x, middle_y}, radius, light, set_).saturated == 0) {
    for (std::size_t k = 0; k < used; ++k) light[k] -= square_.others[k], usable[k] = square_.weight[k];
    return true;
  }
  for (std::int32_t y = middle_y - radius; y <= middle_y + radius; ++y) {
    auto k = static_cast<std::size_t>(y - middle_y + radius) * SpotBatch::kRow;
    for (std::int32_t x = middle_x - radius; x <= middle_x + radius; ++x, ++k) {
      light[k] = usable[k] = 0;
      if (x < 0 || y < 0 || x >= grey.width() || y >= grey.height()) continue;
      const std::size_t pixel = grey.index(x, y);
      light[k] = grey.over(pixel) - square_.others[k];
      if (!grey.saturated(pixel)) usable[k] = square_.weight[k];
    }
  }
  return true;
}

// Takes over the fits that stay a peak and do not run away.
void SpotOverlaps::fit_batch(std::vector<FittedSpot>& spots) noexcept {
  if (batch_size_ == 0) return;
  find_spot_centres(batch_, options_, centres_, set_);
  for (std::size_t lane = 0; lane < batch_size_; ++lane) {
    FittedSpot& spot = spots[in_batch_[lane]];
    const auto [middle_x, middle_y] = spot.middle();
    const double x = middle_x + static_cast<double>(centres_.x[lane]);
    const double y = middle_y + static_cast<double>(centres_.y[lane]);
    spot.misfit = centres_.misfit[lane];
    const bool runs_away =
        std::abs(x - spot.start.x) > ModelImage::kMostMove || std::abs(y - spot.start.y) > ModelImage::kMostMove;
    if (centres_.bend[lane] == 0 || runs_away) continue;
    spot.x_px = x, spot.y_px = y;
    spot.variance_px2 = centres_.variance[lane], spot.grey = centres_.grey[lane];
    spot.peak = centres_.peak[lane], spot.bend = centres_.bend[lane];
  }
  batch_size_ = 0;
}

// Spots of one batch do not see each other's change, so they must not be near; those that are wait for the next round.
// Returns how many fits it made: none is needed where others' light has settled.
template <class Pixel>
std::size_t SpotOverlaps::sweep(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept {
  std::size_t fits = 0;
  pending_.assign(crowded_.begin(), crowded_.end());
  while (!pending_.empty()) {
    deferred_.clear();
    for (const std::uint32_t i : pending_) {
      const bool near = std::any_of(in_batch_.begin(), in_batch_.begin() + static_cast<std::ptrdiff_t>(batch_size_),
                                    [&](std::uint32_t other) {
                                      return std::abs(spots[i].x_px - spots[other].x_px) < seen_px_ &&
                                             std::abs(spots[i].y_px - spots[other].y_px) < seen_px_;
                                    });
      if (near) {
        deferred_.push_back(i);
        continue;
      }
      if (!fill(grey, spots, i)) continue;
      in_batch_[batch_size_++] = i;
      ++fits;
      if (batch_size_ == SpotBatch::kSpots) fit_batch(spots);
    }
    fit_batch(spots);
    pending_.swap(deferred_);
  }
  return fits;
}

template <class Pixel>
std::size_t SpotOverlaps::untangle(const GreyOverBackground<Pixel>& grey, std::vector<FittedSpot>& spots) noexcept {
  expect_width(spots);
  const float sigma_px = options_.expected_bend < 0 ? std::sqrt(-0.5F / options_.expected_bend) : kWidestSigma;
  seen_px_ = static_cast<float>(options_.radius) + kSigmasSeen * sigma_px;
  const float searched_px = seen_px_ + static_cast<float>(kSearchBeyond + 1);
  crowded_.clear();
  std::size_t crowded = 0;
  for (std::uint32_t i = 0; i < spots.size(); ++i) {
    FittedSpot& spot = spots[i];
    spot.crowded =
        spot.bend < 0 && (spot.nearest_px2 < seen_px_ * seen_px_ || (find_hidden_ && spot.misfit > kMostMisfit));
    spot.modelled = spot.bend < 0 && (spot.crowded || spot.nearest_px2 < searched_px * searched_px);
    spot.wide = spot.bend > kWidest * options_.expected_bend;
    crowded += spot.crowded;
  }
  if (crowded == 0) return 0;
  if (crowded > most_crowded_) return crowded;
  for (std::uint32_t i = 0; i < spots.size(); ++i)
    if (spots[i].crowded) crowded_.push_back(i);
  std::size_t left = 0;
  for (int search = 0;; ++search) {
    if (!neighbours_.find(spots, static_cast<std::int32_t>(options_.radius))) {
      left = crowded_.size();
      break;
    }
    std::int64_t done = 0;
    while (done < sweeps_ && sweep(grey, spots) > 0) ++done;
    remove_false(spots);
    if (!find_hidden_ || search == kSearches || find_hidden(grey, spots) == 0) break;
  }
  widen_errors(spots);
  std::erase_if(spots, [](const FittedSpot& spot) { return spot.crowded && spot.peak == 0; });
  return left;
}

template std::size_t SpotOverlaps::untangle(const GreyOverBackground<std::uint8_t>&, std::vector<FittedSpot>&) noexcept;
template std::size_t SpotOverlaps::untangle(const GreyOverBackground<std::uint16_t>&,
                                            std::vector<FittedSpot>&) noexcept;

}  // namespace rptv
