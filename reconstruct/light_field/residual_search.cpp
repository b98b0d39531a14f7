// SPDX-License-Identifier: MIT
// Every footprint at every lenslet; a sample of the pixels first.
#include "reconstruct/light_field/residual_search.hpp"

#include <algorithm>
#include <tuple>

#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {
constexpr float kLeastLight = 0.4F;     // of a particle's, all round: less is not worth a look
constexpr float kSampleMargin = 0.15F;  // that a sample's score may be off
}  // namespace

ResidualSearch::ResidualSearch(const Footprints& footprints, const LensletLattice& lattice, ImageShape shape,
                               std::size_t max_hits, std::size_t threads)
    : footprints_(footprints),
      lattice_(lattice),
      width_(static_cast<std::int32_t>(shape.width_px)),
      height_(static_cast<std::int32_t>(shape.height_px)),
      threads_(threads),
      light_((shape.width_px + 1) * (shape.height_px + 1)),
      of_thread_(threads) {
  hits_.reserve(max_hits);
  for (auto& found : of_thread_) found.hits.reserve(max_hits);
}

void ResidualSearch::sum_light(std::span<const float> residual, float faint) noexcept {
  const auto width = static_cast<std::size_t>(width_), stride = width + 1;
  for (std::size_t row = 0; row < static_cast<std::size_t>(height_); ++row) {
    double sum = 0;
    for (std::size_t column = 0; column < width; ++column) {
      const float grey = residual[row * width + column];
      sum += grey > faint ? static_cast<double>(grey) : 0;
      light_[(row + 1) * stride + column + 1] = light_[row * stride + column + 1] + sum;
    }
  }
}

// In the box that a footprint lies in.
float ResidualSearch::light_in(const Place& place) const noexcept {
  const auto& f = place.footprint;
  const std::int32_t left = std::max(place.column + f.left, 0), right = std::min(place.column + f.right + 1, width_);
  const std::int32_t top = std::max(place.row + f.top, 0), bottom = std::min(place.row + f.bottom + 1, height_);
  const auto at = [&](std::int32_t column, std::int32_t row) {
    return light_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_ + 1) +
                  static_cast<std::size_t>(column)];
  };
  return static_cast<float>(at(right, bottom) - at(left, bottom) - at(right, top) + at(left, top));
}

ResidualSearch::Place ResidualSearch::place_of(std::uint32_t footprint,
                                               std::array<std::int32_t, 2> spot) const noexcept {
  const auto& f = footprints_.all()[footprint];
  const bool inside =
      spot[0] + f.left >= 0 && spot[0] + f.right < width_ && spot[1] + f.top >= 0 && spot[1] + f.bottom < height_;
  return {f, spot[0], spot[1], inside};
}

// Over pixels first … last - 1 of the footprint, those off the sensor left out.
float ResidualSearch::score_at(std::span<const float> residual, const Place& place, std::uint32_t first,
                               std::uint32_t last) const noexcept {
  const auto pixels = footprints_.pixels(place.footprint).subspan(first, last - first);
  const std::int32_t spot = place.row * width_ + place.column;
  float sum = 0;
  if (place.inside) {
    const float* here = residual.data() + spot;
    for (const auto& p : pixels) {
      const float seen = std::max(std::min(here[p.offset], p.grey), -p.grey);
      sum += (2 * seen - p.grey) * p.weighted;
    }
    return sum;
  }
  for (const auto& p : pixels) {
    const std::int32_t column = place.column + p.column, row = place.row + p.row;
    if (column < 0 || column >= width_ || row < 0 || row >= height_) continue;
    const float seen = std::max(std::min(residual[static_cast<std::size_t>(spot + p.offset)], p.grey), -p.grey);
    sum += (2 * seen - p.grey) * p.weighted;
  }
  return sum;
}

void ResidualSearch::find_near(std::span<const float> residual, std::uint32_t lenslet, float least_score,
                               Found& found) noexcept {
  const auto spot = footprints_.spot_px(lenslet);
  if (spot[0] < 0 || spot[0] >= width_ || spot[1] < 0 || spot[1] >= height_ || lattice_.masked(lenslet) != 0) return;
  const auto count = static_cast<std::uint32_t>(footprints_.all().size());
  for (std::uint32_t k = 0; k < count; ++k) {
    const Place place = place_of(k, spot);
    const auto& f = place.footprint;
    if (f.count == 0 || light_in(place) < kLeastLight * f.grey) continue;
    const float sampled = score_at(residual, place, 0, f.sampled);
    if (sampled < (least_score - kSampleMargin) * f.sampled_norm) continue;
    const float score = (sampled + score_at(residual, place, f.sampled, f.count)) / f.norm;
    if (score < least_score) continue;
    if (found.hits.size() < found.hits.capacity())
      found.hits.push_back({score, k, lenslet});
    else
      ++found.refused;
  }
}

std::span<const ResidualHit> ResidualSearch::find(std::span<const float> residual, float least_score,
                                                  float faint) noexcept {
  sum_light(residual, faint);
  for (auto& found : of_thread_) found.hits.clear(), found.refused = 0;
  parallel_for(lattice_.rows(), threads_, [&](std::size_t row, std::size_t thread) {
    for (std::uint32_t column = 0; column < lattice_.columns(); ++column)
      find_near(residual, static_cast<std::uint32_t>(row) * lattice_.columns() + column, least_score,
                of_thread_[thread]);
  });
  hits_.clear();
  refused_ = 0;
  for (const auto& [hits, refused] : of_thread_) {
    const std::size_t room = std::min(hits.size(), hits_.capacity() - hits_.size());
    refused_ += refused + hits.size() - room;
    hits_.insert(hits_.end(), hits.begin(), hits.begin() + static_cast<std::ptrdiff_t>(room));
  }
  std::sort(hits_.begin(), hits_.end(), [](const ResidualHit& a, const ResidualHit& b) {
    return std::tie(b.score, a.lenslet, a.footprint) < std::tie(a.score, b.lenslet, b.footprint);
  });
  return hits_;
}

float ResidualSearch::score(std::span<const float> residual, const ResidualHit& hit) const noexcept {
  const Place place = place_of(hit.footprint, footprints_.spot_px(hit.lenslet));
  return score_at(residual, place, 0, place.footprint.count) / place.footprint.norm;
}

void ResidualSearch::subtract(std::span<float> residual, const ResidualHit& hit) const noexcept {
  const Place place = place_of(hit.footprint, footprints_.spot_px(hit.lenslet));
  const std::int32_t spot = place.row * width_ + place.column;
  for (const auto& p : footprints_.pixels(place.footprint)) {
    const std::int32_t column = place.column + p.column, row = place.row + p.row;
    if (column < 0 || column >= width_ || row < 0 || row >= height_) continue;
    residual[static_cast<std::size_t>(spot + p.offset)] -= p.grey;
  }
}

}  // namespace rptv
