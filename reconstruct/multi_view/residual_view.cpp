// SPDX-License-Identifier: MIT
// Loops over pixels and spots, compiled once per instruction set.
#include "reconstruct/multi_view/residual_view.hpp"

#include <algorithm>
#include <cstring>

#include "reconstruct/multi_view/view_spot_kernel.hpp"

namespace rptv {

namespace {

#if defined(__x86_64__)
#define RPTV_SPOT_AVX2 [[gnu::target("avx2")]]
#endif

RPTV_LANES void subtract_one(const ViewSpot& spot, float* pixels, const PaddedRaster& raster) noexcept {
  if (!raster.near(spot)) return;
  SpotPatch patch;
  fill_patch(patch, spot);
  float* first = pixels + raster.index(patch.across.first, patch.down.first);
  for (std::size_t j = patch.row_from; j < patch.row_to; ++j)
    for (std::size_t c = 0; c < patch.chunks; ++c) {
      float* place = first + j * raster.stride + 8 * c;
      SpotLanes left, share;
      std::memcpy(&left, place, sizeof left);
      std::memcpy(&share, patch.across.share + 8 * c, sizeof share);
      left -= share * (spot.grey * patch.down.share[j]);
      std::memcpy(place, &left, sizeof left);
    }
}

RPTV_LANES float total(SpotLanes lanes) noexcept {
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

RPTV_LANES SpotSums sums_of(const ViewSpot& spot, const float* residual, const float* weight,
                            const PaddedRaster& raster) noexcept {
  SpotPatch patch;
  fill_patch(patch, spot);
  const std::size_t first = raster.index(patch.across.first, patch.down.first);
  SpotLanes mm{}, um{}, vm{}, uu{}, uv{}, vv{}, mr{}, ur{}, vr{}, rr{};
  for (std::size_t j = patch.row_from; j < patch.row_to; ++j)
    for (std::size_t c = 0; c < patch.chunks; ++c) {
      const std::size_t i = first + j * raster.stride + 8 * c;
      SpotLanes r, w, share, slope;
      std::memcpy(&r, residual + i, sizeof r);
      std::memcpy(&w, weight + i, sizeof w);
      std::memcpy(&share, patch.across.share + 8 * c, sizeof share);
      std::memcpy(&slope, patch.across.slope + 8 * c, sizeof slope);
      const SpotLanes m = share * patch.down.share[j], u = slope * patch.down.share[j], v = share * patch.down.slope[j];
      const SpotLanes wm = w * m, wu = w * u, wv = w * v;
      mm += wm * m, um += wu * m, vm += wv * m, uu += wu * u, uv += wu * v, vv += wv * v;
      mr += wm * r, ur += wu * r, vr += wv * r, rr += w * r * r;
    }
  return {total(mm), total(um), total(vm), total(uu), total(uv), total(vv), total(mr), total(ur), total(vr), total(rr)};
}

#define RPTV_SPOT_LOOPS(SET, TARGET)                                                                                \
  TARGET void subtract_##SET(std::span<const ViewSpot> spots, float* pixels, const PaddedRaster& raster) noexcept { \
    for (const ViewSpot& spot : spots) subtract_one(spot, pixels, raster);                                          \
  }                                                                                                                 \
  TARGET SpotSums sums_##SET(const ViewSpot& spot, const float* residual, const float* weight,                      \
                             const PaddedRaster& raster) noexcept {                                                 \
    return sums_of(spot, residual, weight, raster);                                                                 \
  }

RPTV_SPOT_LOOPS(portable, )
#if defined(__x86_64__)
RPTV_SPOT_LOOPS(avx2, RPTV_SPOT_AVX2)
#endif

}  // namespace

ResidualView::ResidualView(const ImageShape& shape, const GreyNoise& noise, double saturation_grey, InstructionSet set)
    : raster_(shape), noise_(noise), saturation_grey_(saturation_grey), set_(set) {
  for (auto* image : {&grey_, &residual_, &weight_}) image->resize(raster_.size());
}

template <class Pixel>
void ResidualView::load_as(const ImageView& image, const DarkPixels& dark) noexcept {
  const GreyOverBackground<Pixel> grey(image, dark, saturation_grey_);
  for (int y = 0; y < height_px(); ++y)
    for (int x = 0; x < width_px(); ++x) {
      const std::size_t from = grey.index(x, y), to = raster_.index(x, y);
      const float over = grey.over(from);
      grey_[to] = over;
      weight_[to] = grey.saturated(from) ? 0 : 1 / noise_.variance(over);
    }
}

void ResidualView::load(const ImageView& image, const DarkPixels& dark) noexcept {
  if (image.shape.bytes_per_pixel == 1)
    load_as<std::uint8_t>(image, dark);
  else
    load_as<std::uint16_t>(image, dark);
  restore();
}

void ResidualView::load_nothing() noexcept {
  std::fill(grey_.begin(), grey_.end(), 0.0F);
  std::fill(weight_.begin(), weight_.end(), 0.0F);
  restore();
}

void ResidualView::restore() noexcept { std::copy(grey_.begin(), grey_.end(), residual_.begin()); }

void ResidualView::subtract(std::span<const ViewSpot> spots) noexcept {
#if defined(__x86_64__)
  if (set_ != InstructionSet::portable) return subtract_avx2(spots, residual_.data(), raster_);
#endif
  subtract_portable(spots, residual_.data(), raster_);
}

SpotSums ResidualView::sums(const ViewSpot& spot) const noexcept {
#if defined(__x86_64__)
  if (set_ != InstructionSet::portable) return sums_avx2(spot, residual_.data(), weight_.data(), raster_);
#endif
  return sums_portable(spot, residual_.data(), weight_.data(), raster_);
}

}  // namespace rptv
