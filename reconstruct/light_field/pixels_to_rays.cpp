// SPDX-License-Identifier: MIT
// Lit pixels to rays, sorted by lenslet by counting.
#include "reconstruct/light_field/pixels_to_rays.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {
constexpr std::size_t kAhead = 64;  // lit pixels are far apart in the table, and memory is slow
}

PixelsToRays::PixelsToRays(const LightFieldCalibration& calibration, const LensletLattice& lattice,
                           std::size_t hypotheses)
    : lattice_(lattice),
      hypotheses_(hypotheses),
      width_(static_cast<std::uint32_t>(calibration.sensor.width_px)),
      optics_{static_cast<float>(calibration.optical_axis_px()[0]),
              static_cast<float>(calibration.optical_axis_px()[1]), static_cast<float>(calibration.pixel_mm()),
              static_cast<float>(1 / calibration.lenslets.focal_length_mm)} {
  const auto [axis_x, axis_y] = calibration.optical_axis_px();
  const auto height = static_cast<std::uint32_t>(calibration.sensor.height_px);
  lenslets_.resize(std::size_t{width_} * height * hypotheses_);
  double farthest_mm = 0;
  for (std::uint32_t row = 0; row < height; ++row)
    for (std::uint32_t column = 0; column < width_; ++column) {
      const double x = (column - axis_x) * calibration.pixel_mm(), y = (row - axis_y) * calibration.pixel_mm();
      const std::span<std::uint32_t> mine(&lenslets_[(std::size_t{row} * width_ + column) * hypotheses_], hypotheses_);
      lattice.lenslets_of(x, y, mine);
      for (const auto lenslet : mine) {
        if (lenslet == LensletLattice::kNone) continue;
        const auto [spot_x, spot_y] = lattice.spot_mm(lenslet);
        farthest_mm = std::max({farthest_mm, std::abs(x - spot_x), std::abs(y - spot_y)});
      }
    }
  slope_half_range_ = farthest_mm / calibration.lenslets.focal_length_mm;
}

std::size_t PixelsToRays::convert(std::span<const std::uint32_t> lit, Rays& rays) const noexcept {
  auto& first = rays.first_of_lenslet;
  std::fill(first.begin(), first.end(), 0U);
  std::size_t total = 0, pixels = 0;
  std::uint32_t* kept =
      rays.kept_lenslets.data();           // per pixel: lenslets, then how many, so that it can be read from behind
  for (; pixels < lit.size(); ++pixels) {  // count rays per lenslet
    if (pixels + kAhead < lit.size()) __builtin_prefetch(&lenslets_[lit[pixels + kAhead] * hypotheses_]);
    const auto* mine = &lenslets_[lit[pixels] * hypotheses_];
    if (total + hypotheses_ > rays.capacity() || pixels == rays.capacity()) break;
    std::uint32_t have = 0;
    for (; have < hypotheses_ && mine[have] != LensletLattice::kNone; ++have) {
      ++first[mine[have] + 1];
      *kept++ = mine[have];
    }
    *kept++ = have;
    total += have;
  }
  for (std::size_t l = 1; l < first.size(); ++l) first[l] += first[l - 1];
  std::uint32_t row = pixels > 0 ? lit[pixels - 1] / width_ : 0, row_start = row * width_;
  for (std::size_t p = pixels; p-- > 0;) {  // place them from behind; first[l + 1] walks down to the start of l
    const std::uint32_t have = *--kept;
    kept -= have;
    while (lit[p] < row_start) row_start -= width_, --row;
    std::uint32_t first_at = 0, last_at = 0;
    for (std::size_t k = 0; k < have; ++k) {
      const auto at = --first[kept[k] + 1];
      const auto [centre_x, centre_y] = lattice_.centre_mm(kept[k]);
      rays.ray[at] = ray_of(optics_, lit[p] - row_start, row, centre_x, centre_y);
      rays.pixel[at] = static_cast<std::uint32_t>(p);
      if (k == 0) first_at = at;
      rays.same_pixel[at] = first_at, rays.same_pixel[k == 0 ? at : last_at] = at;
      last_at = at;
    }
  }
  // Now first[l + 1] is the start of lenslet l: move down by one and close with the total.
  std::copy(first.begin() + 1, first.end(), first.begin());
  first.back() = static_cast<std::uint32_t>(total);
  rays.size = total;
  rays.pixels = pixels;
  return lit.size() - pixels;
}

}  // namespace rptv
