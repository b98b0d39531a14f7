// SPDX-License-Identifier: MIT
// From maxima to spots: noise and plateaus merged, pixels between neighbours shared out, centres sixteen at a time.
#include "reconstruct/spot_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reconstruct/near_pairs.hpp"

namespace rptv {

namespace {

constexpr std::size_t kMaximaPerDetection = 4;
constexpr std::size_t kPairsPerMaximum = 8;  // beyond them neighbours keep the pixels between them to themselves
constexpr std::size_t kFewestPixels = 6;     // that can tell the four numbers of a Gaussian and some noise

SpotMethod method_of(const std::string& name) {
  return name == "three_point" ? SpotMethod::three_point
         : name == "centroid"  ? SpotMethod::centroid
                               : SpotMethod::gaussian;
}

SpotOptions options_of(const DetectorSettings& settings) {
  const auto noise = GreyNoise::of(settings.noise_grey, settings.electrons_per_grey);
  return {method_of(settings.method), static_cast<std::size_t>(settings.radius_px), noise.dark_variance,
          noise.grey_per_electron};
}

// Least raw grey value on the straight line between two pixels, both left out.
template <class Pixel>
float least_between(const GreyOverBackground<Pixel>& grey, PixelIndex a, PixelIndex b) noexcept {
  const std::int32_t dx = b.x - a.x, dy = b.y - a.y, steps = std::max(std::abs(dx), std::abs(dy));
  Pixel lowest = std::numeric_limits<Pixel>::max();
  for (std::int32_t k = 1; k < steps; ++k) {
    const auto along = [&](std::int32_t way) { return (2 * k * way + (way < 0 ? -steps : steps)) / (2 * steps); };
    lowest = std::min(lowest, grey.raw(grey.index(a.x + along(dx), a.y + along(dy))));
  }
  return static_cast<float>(lowest);
}

// Centre of light and rows of saturated pixels below the first of them, `top`; exact where they are convex.
struct Plateau {
  double x = 0, y = 0, rows = 0;
};

template <class Pixel>
Plateau plateau_of(const GreyOverBackground<Pixel>& grey, PixelIndex top) noexcept {
  constexpr std::int32_t kMost = 64;  // pixels aside and rows
  Plateau plateau;
  double pixels = 0;
  const auto saturated = [&](std::int32_t x, std::int32_t y) {
    return x >= 0 && x < grey.width() && grey.saturated(grey.index(x, y));
  };
  std::int32_t middle = top.x;
  for (std::int32_t y = top.y; y < std::min(grey.height(), top.y + kMost) && saturated(middle, y); ++y) {
    std::int32_t first = middle, last = middle;
    while (middle - first < kMost && saturated(first - 1, y)) --first;
    while (last - middle < kMost && saturated(last + 1, y)) ++last;
    const double length = last - first + 1;
    plateau.x += length * (first + last) / 2, plateau.y += length * y, pixels += length;
    ++plateau.rows;
    middle = (first + last) / 2;
  }
  plateau.x /= pixels, plateau.y /= pixels;
  return plateau;
}

}  // namespace

SpotFinder::SpotFinder(const DetectorSettings& settings, InstructionSet set)
    : set_(set),
      options_(options_of(settings)),
      noise_(GreyNoise::of(settings.noise_grey, settings.electrons_per_grey)),
      split_sigmas_(static_cast<float>(settings.split_sigmas)),
      saturation_grey_(settings.saturation_grey),
      min_area_px_(static_cast<std::size_t>(settings.min_area_px)),
      room_(kMaximaPerDetection * static_cast<std::size_t>(settings.max_detections)),
      dropped_(room_.size()) {
  spots_.reserve(room_.size());
  pairs_.reserve(kPairsPerMaximum * room_.size());
}

// Of two maxima the lower one is noise on the other's image, or one more corner of its plateau, when the grey between
// them falls by no more than noise does.
template <class Pixel>
void SpotFinder::drop_noise(const GreyOverBackground<Pixel>& grey, DetectorCounts& counts) noexcept {
  const std::int32_t reach = 2 * static_cast<std::int32_t>(options_.radius) + 1;
  std::fill(dropped_.begin(), dropped_.begin() + static_cast<std::ptrdiff_t>(maxima_.size()), std::uint8_t{0});
  pairs_.clear();
  each_near_pair(maxima_, reach, [&](std::size_t i, std::size_t j) {
    if (pairs_.size() < pairs_.capacity()) pairs_.push_back({i, j});
    const std::size_t first = grey.index(maxima_[i].x, maxima_[i].y), second = grey.index(maxima_[j].x, maxima_[j].y);
    const bool first_is_lower = grey.raw(first) < grey.raw(second);
    const std::size_t lower = first_is_lower ? first : second;
    const float noise = std::sqrt(noise_.variance(grey.over(lower)));
    if (least_between(grey, maxima_[i], maxima_[j]) >= static_cast<float>(grey.raw(lower)) - split_sigmas_ * noise)
      dropped_[first_is_lower ? i : j] = 1;
  });
  for (std::size_t i = 0; i < maxima_.size(); ++i) counts.merged += dropped_[i];
}

template <class Pixel>
void SpotFinder::place_squares(const GreyOverBackground<Pixel>& grey) noexcept {
  spots_.clear();
  for (const PixelIndex maximum : maxima_) {
    Spot spot{maximum, 0, 0, 0, 0};
    if (grey.saturated(grey.index(maximum.x, maximum.y))) {
      const Plateau plateau = plateau_of(grey, maximum);
      spot.plateau_x = plateau.x, spot.plateau_y = plateau.y, spot.plateau_rows = plateau.rows;
      spot.middle = {static_cast<std::int32_t>(std::lround(plateau.x)),
                     static_cast<std::int32_t>(std::lround(plateau.y))};
    }
    spots_.push_back(spot);
  }
}

// A pixel belongs to the nearest maximum; halfway between, to neither.
void SpotFinder::share_pixels() noexcept {
  const auto radius = static_cast<std::int32_t>(options_.radius);
  const auto yield_to = [radius](Spot& spot, PixelIndex other) {
    const std::int32_t ox = other.x - spot.middle.x, oy = other.y - spot.middle.y;
    std::uint64_t bit = 1;
    for (std::int32_t dy = -radius; dy <= radius; ++dy)
      for (std::int32_t dx = -radius; dx <= radius; ++dx, bit <<= 1)
        if (2 * (dx * ox + dy * oy) >= ox * ox + oy * oy) spot.neighbours |= bit;
  };
  for (const auto& [i, j] : pairs_) {
    if (dropped_[i] != 0 || dropped_[j] != 0) continue;
    yield_to(spots_[i], spots_[j].middle);
    yield_to(spots_[j], spots_[i].middle);
  }
}

// Copies the square of a spot into its lane. Lit pixels are those above the limit of the middle one.
template <class Pixel>
void SpotFinder::fill(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept {
  const auto radius = static_cast<std::int32_t>(options_.radius);
  const auto [middle_x, middle_y] = spot.middle;
  const float dark = grey.dark(grey.index(middle_x, middle_y));
  std::size_t k = 0, lit = 0, usable = 0;
  for (std::int32_t y = middle_y - radius; y <= middle_y + radius; ++y)
    for (std::int32_t x = middle_x - radius; x <= middle_x + radius; ++x, ++k) {
      const bool inside = x >= 0 && y >= 0 && x < grey.width() && y < grey.height();
      const bool own = inside && (spot.neighbours >> k & 1) == 0;
      const float over = own ? grey.over(grey.index(x, y)) : 0;
      const bool tells = own && !grey.saturated(grey.index(x, y));
      batch_.grey[k][lane] = over;
      batch_.usable[k][lane] = tells ? 1.0F : 0.0F;
      usable += tells, lit += own && over > dark;
    }
  lanes_[lane] = {&spot, lit, usable};
}

// The same for most spots, which have their square for themselves, without a branch; false when this is not one of
// them.
template <class Pixel>
bool SpotFinder::fill_plain(const GreyOverBackground<Pixel>& grey, const Spot& spot, std::size_t lane) noexcept {
  const auto radius = static_cast<std::int32_t>(options_.radius);
  const auto [middle_x, middle_y] = spot.middle;
  if (spot.neighbours != 0 || middle_x < radius || middle_y < radius || middle_x + radius >= grey.width() ||
      middle_y + radius >= grey.height())
    return false;
  const std::size_t side = 2 * options_.radius + 1;
  const float dark = grey.dark(grey.index(middle_x, middle_y));
  std::size_t k = 0, lit = 0, saturated = 0;
  for (std::int32_t y = middle_y - radius; y <= middle_y + radius; ++y) {
    const std::size_t first = grey.index(middle_x - radius, y);
    for (std::size_t i = first; i < first + side; ++i, ++k) {
      const float over = grey.over(i);
      batch_.grey[k][lane] = over;
      batch_.usable[k][lane] = 1;
      lit += over > dark, saturated += grey.saturated(i);
    }
  }
  lanes_[lane] = {&spot, lit, side * side};
  return saturated == 0;
}

void SpotFinder::push(std::size_t lanes, Detections& out) noexcept {
  if (lanes == 0) return;
  find_spot_centres(batch_, options_, centres_, set_);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const auto& [spot, lit, usable] = lanes_[lane];
    Detection found;
    found.x_px = spot->middle.x + static_cast<double>(centres_.x[lane]);
    found.y_px = spot->middle.y + static_cast<double>(centres_.y[lane]);
    found.sigma_px = std::sqrt(static_cast<double>(centres_.variance[lane]));
    if (spot->plateau_rows > 0 && usable < kFewestPixels) {  // both ends of each row are known to a pixel
      found.x_px = spot->plateau_x, found.y_px = spot->plateau_y;
      found.sigma_px = std::sqrt(1 / (24 * spot->plateau_rows));
    }
    found.grey = static_cast<double>(centres_.grey[lane]);
    found.area_px = static_cast<double>(lit);
    out.push(found);
  }
}

template <class Pixel>
void SpotFinder::find(const ImageView& image, const DarkPixels& dark, Detections& out,
                      DetectorCounts& counts) noexcept {
  const GreyOverBackground<Pixel> grey(image, dark, saturation_grey_);
  const std::size_t all = find_lit_maxima(image, dark.limit, room_, set_);
  maxima_ = std::span(room_).first(std::min(all, room_.size()));
  counts.refused_maxima += all - maxima_.size();
  out.refuse(all - maxima_.size());
  drop_noise(grey, counts);
  place_squares(grey);
  share_pixels();
  constexpr std::size_t kAhead = 6;
  std::size_t lanes = 0;
  for (std::size_t i = 0; i < spots_.size(); ++i) {
    if (i + kAhead < spots_.size())
      grey.prefetch_square(spots_[i + kAhead].middle, static_cast<std::int32_t>(options_.radius));
    if (dropped_[i] != 0) continue;
    if (!fill_plain(grey, spots_[i], lanes)) fill(grey, spots_[i], lanes);
    if (lanes_[lanes].lit < min_area_px_) {
      ++counts.too_small;
      continue;
    }
    if (++lanes < SpotBatch::kSpots) continue;
    push(lanes, out);
    lanes = 0;
  }
  push(lanes, out);
}

template void SpotFinder::find<std::uint8_t>(const ImageView&, const DarkPixels&, Detections&,
                                             DetectorCounts&) noexcept;
template void SpotFinder::find<std::uint16_t>(const ImageView&, const DarkPixels&, Detections&,
                                              DetectorCounts&) noexcept;

}  // namespace rptv
