// SPDX-License-Identifier: MIT
// From spots to detections: squares copied, centres found sixteen at a time, overlaps untangled.
#include "reconstruct/detection/spot_finder.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruct/detection/spot_square.hpp"

namespace rptv {

namespace {

constexpr std::size_t kFewestPixels = 6;  // that can tell the four numbers of a Gaussian and some noise

SpotMethod method_of(const std::string& name) {
  return name == "three_point" ? SpotMethod::three_point
         : name == "centroid"  ? SpotMethod::centroid
                               : SpotMethod::gaussian;
}

}  // namespace

SpotOptions spot_options(const DetectorSettings& settings) {
  const auto noise = GreyNoise::of(settings.noise_grey, settings.electrons_per_grey);
  return {method_of(settings.method), static_cast<std::size_t>(settings.radius_px), noise.dark_variance,
          noise.grey_per_electron};
}

SpotFinder::SpotFinder(const DetectorSettings& settings, const ImageShape& shape, InstructionSet set)
    : set_(set),
      options_(spot_options(settings)),
      saturation_grey_(settings.saturation_grey),
      min_area_px_(static_cast<std::size_t>(settings.min_area_px)),
      maxima_(kMaximaPerDetection * static_cast<std::size_t>(settings.max_detections)),
      separate_(settings, maxima_.size(), set) {
  fitted_.reserve(maxima_.size());
  if (options_.method == SpotMethod::gaussian && settings.overlap_sweeps > 0)
    overlaps_.emplace(settings, shape, options_, fitted_.capacity(), set);
}

// Copies the square of a spot into its lane.
template <class Pixel>
void SpotFinder::fill(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept {
  const auto radius = static_cast<std::int32_t>(options_.radius);
  const std::size_t side = 2 * options_.radius + 1;
  if (spot.neighbours == 0 && has_whole_rows(grey, spot.middle, radius)) {  // most spots
    const SquareCounts counts = copy_square(grey, spot.middle, radius, batch_.grey[lane], set_);
    if (counts.saturated == 0) {
      if (!batch_.all_usable[lane]) batch_.usable[lane].fill(1);
      batch_.all_usable[lane] = true;
      lanes_[lane] = {&spot, counts.lit, side * side};
      return;
    }
  }
  batch_.all_usable[lane] = false;
  fill_with_care(grey, spot, lane);
}

// The same where pixels are missing: beyond the border, saturated, or another spot's.
template <class Pixel>
void SpotFinder::fill_with_care(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept {
  const auto radius = static_cast<std::int32_t>(options_.radius);
  const auto [middle_x, middle_y] = spot.middle;
  const float dark = grey.dark(grey.index(middle_x, middle_y));
  std::size_t lit = 0, usable = 0, bit = 0;
  for (std::int32_t dy = -radius; dy <= radius; ++dy) {
    auto k = static_cast<std::size_t>(dy + radius) * SpotBatch::kRow;
    for (std::int32_t dx = -radius; dx <= radius; ++dx, ++k, ++bit) {
      const std::int32_t x = middle_x + dx, y = middle_y + dy;
      const bool inside = x >= 0 && y >= 0 && x < grey.width() && y < grey.height();
      const bool own = inside && (spot.neighbours >> bit & 1) == 0;
      const float over = own ? grey.over(grey.index(x, y)) : 0;
      const bool tells = own && !grey.saturated(grey.index(x, y));
      batch_.grey[lane][k] = over;
      batch_.usable[lane][k] = tells ? 1.0F : 0.0F;
      usable += tells, lit += own && over > dark;
    }
  }
  lanes_[lane] = {&spot, lit, usable};
}

void SpotFinder::fit(std::size_t lanes) noexcept {
  if (lanes == 0) return;
  find_spot_centres(batch_, options_, centres_, set_);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const auto& [spot, lit, usable] = lanes_[lane];
    FittedSpot fitted;
    fitted.start = spot->middle;
    fitted.x_px = spot->middle.x + static_cast<double>(centres_.x[lane]);
    fitted.y_px = spot->middle.y + static_cast<double>(centres_.y[lane]);
    fitted.variance_px2 = centres_.variance[lane];
    fitted.grey = centres_.grey[lane], fitted.area_px = static_cast<float>(lit);
    fitted.peak = centres_.peak[lane], fitted.bend = centres_.bend[lane], fitted.misfit = centres_.misfit[lane];
    fitted.nearest_px2 = spot->nearest_px2;
    if (spot->plateau_rows > 0 && usable < kFewestPixels) {  // both ends of each row are known to a pixel
      fitted.x_px = spot->plateau_x, fitted.y_px = spot->plateau_y;
      fitted.variance_px2 = static_cast<float>(1 / (24 * spot->plateau_rows));
      fitted.bend = 0;
    }
    fitted_.push_back(fitted);
  }
}

template <class Pixel>
void SpotFinder::fit_all(const GreyOverBackground<Pixel>& grey, std::span<const Spot> spots,
                         DetectorCounts& counts) noexcept {
  constexpr std::size_t kAhead = 6;
  std::size_t lanes = 0;
  fitted_.clear();
  for (std::size_t i = 0; i < spots.size(); ++i) {
    if (i + kAhead < spots.size())
      grey.prefetch_square(spots[i + kAhead].middle, static_cast<std::int32_t>(options_.radius));
    if (spots[i].merged) {
      ++counts.merged;
      continue;
    }
    fill(grey, spots[i], lanes);
    if (lanes_[lanes].lit < min_area_px_) {
      ++counts.too_small;
      continue;
    }
    if (++lanes < SpotBatch::kSpots) continue;
    fit(lanes);
    lanes = 0;
  }
  fit(lanes);
}

template <class Pixel>
void SpotFinder::find(const ImageView& image, const DarkPixels& dark, Detections& out,
                      DetectorCounts& counts) noexcept {
  const GreyOverBackground<Pixel> grey(image, dark, saturation_grey_);
  const std::size_t all = find_lit_maxima(image, dark.limit, maxima_, set_), taken = std::min(all, maxima_.size());
  counts.refused_maxima += all - taken;
  out.refuse(all - taken);
  fit_all(grey, separate_.separate(grey, std::span(maxima_).first(taken)), counts);
  if (overlaps_) counts.too_crowded += overlaps_->untangle(grey, fitted_);
  for (const FittedSpot& spot : fitted_)
    out.push({spot.x_px, spot.y_px, std::sqrt(static_cast<double>(spot.variance_px2)), static_cast<double>(spot.grey),
              static_cast<double>(spot.area_px), 0, 0, 0});
}

template void SpotFinder::find<std::uint8_t>(const ImageView&, const DarkPixels&, Detections&,
                                             DetectorCounts&) noexcept;
template void SpotFinder::find<std::uint16_t>(const ImageView&, const DarkPixels&, Detections&,
                                              DetectorCounts&) noexcept;

}  // namespace rptv
