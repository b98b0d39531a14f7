// SPDX-License-Identifier: MIT
// A thread a maximum, in four steps: place squares, drop noise, fit, write in raster order.
#include "reconstruct/detection/spots_cuda.hpp"

#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/cuda_scan.hpp"
#include "reconstruct/detection/cuda_grey.hpp"
#include "reconstruct/detection/near_grey_kernel.hpp"
#include "reconstruct/detection/spot_centre_kernel.hpp"

namespace rptv {

namespace {

__device__ std::uint32_t count_of(const CudaMaxima& maxima, std::int32_t height) {
  return min(maxima.row_start[height], maxima.capacity);
}

// visit(j) for the other maxima whose columns and rows differ by at most `reach` from those of i.
template <class Visit>
__device__ void each_near(const CudaMaxima& maxima, std::int32_t height, std::uint32_t i, std::int32_t reach,
                          const Visit& visit) {
  const std::int32_t last = min(maxima.y[i] + reach, height - 1);
  for (std::int32_t y = max(maxima.y[i] - reach, 0); y <= last; ++y) {
    const std::uint32_t until = min(maxima.row_start[y + 1], maxima.capacity);
    for (std::uint32_t j = maxima.row_start[y]; j < until; ++j) {
      const std::int32_t apart = maxima.x[j] - maxima.x[i];
      if (apart > reach) break;
      if (apart >= -reach && j != i) visit(j);
    }
  }
}

template <class Pixel>
__global__ void place_squares(CudaGrey<Pixel> grey, CudaMaxima maxima, CudaSpots spots) {
  const std::uint32_t count = count_of(maxima, grey.height());
  for (std::uint32_t i = cuda_item(); i < count; i += cuda_stride()) {
    spots.middle_x[i] = maxima.x[i], spots.middle_y[i] = maxima.y[i], spots.plateau_rows[i] = 0;
    if (!grey.saturated(grey.index(maxima.x[i], maxima.y[i]))) continue;
    const Plateau plateau = plateau_of(grey, maxima.x[i], maxima.y[i]);
    spots.plateau_x[i] = plateau.x, spots.plateau_y[i] = plateau.y, spots.plateau_rows[i] = plateau.rows;
    spots.middle_x[i] = static_cast<std::int32_t>(lround(plateau.x));
    spots.middle_y[i] = static_cast<std::int32_t>(lround(plateau.y));
  }
}

// Of two maxima the lower one is noise on the other's image, or one more corner of its plateau, when the grey between
// them falls by no more than noise does.
template <class Pixel>
__global__ void drop_noise(CudaGrey<Pixel> grey, CudaMaxima maxima, CudaSpotSettings settings, CudaSpots spots,
                           CudaSpotCounts* counts) {
  const std::uint32_t count = count_of(maxima, grey.height());
  for (std::uint32_t i = cuda_item(); i < count; i += cuda_stride()) {
    const std::size_t own = grey.index(maxima.x[i], maxima.y[i]);
    const float least = static_cast<float>(grey.raw(own)) -
                        settings.split_sigmas * std::sqrt(noise_of(settings.options, grey.over(own)));
    bool merged = false;
    each_near(maxima, grey.height(), i, settings.merge_reach_px, [&](std::uint32_t j) {
      const auto other = grey.raw(grey.index(maxima.x[j], maxima.y[j]));
      const bool lower = i < j ? grey.raw(own) < other : grey.raw(own) <= other;
      const std::uint32_t a = min(i, j), b = max(i, j);
      merged = merged || (lower && least_between(grey, maxima.x[a], maxima.y[a], maxima.x[b], maxima.y[b]) >= least);
    });
    spots.merged[i] = merged;
    if (merged) atomicAdd(&counts->merged, 1ULL);
  }
}

// A pixel belongs to the nearest maximum; halfway between, to neither.
__device__ std::uint64_t pixels_of_others(const CudaMaxima& maxima, std::int32_t height,
                                          const CudaSpotSettings& settings, const CudaSpots& spots, std::uint32_t i) {
  const auto radius = static_cast<std::int32_t>(settings.options.radius);
  std::uint64_t neighbours = 0;
  each_near(maxima, height, i, settings.reach_px, [&](std::uint32_t j) {
    if (spots.merged[j] != 0) return;
    const std::int32_t ox = spots.middle_x[j] - spots.middle_x[i], oy = spots.middle_y[j] - spots.middle_y[i];
    std::uint64_t bit = 1;
    for (std::int32_t dy = -radius; dy <= radius; ++dy)
      for (std::int32_t dx = -radius; dx <= radius; ++dx, bit <<= 1)
        if (2 * (dx * ox + dy * oy) >= ox * ox + oy * oy) neighbours |= bit;
  });
  return neighbours;
}

template <class Pixel>
__global__ void fit_spots(CudaGrey<Pixel> grey, CudaMaxima maxima, CudaSpotSettings settings, CudaSpots spots,
                          CudaSpotCounts* counts) {
  constexpr float kFewestPixels = 6;  // that can tell the four numbers of a Gaussian and some noise
  const std::uint32_t count = count_of(maxima, grey.height());
  for (std::uint32_t i = cuda_item(); i < count; i += cuda_stride()) {
    spots.kept[i] = spots.place[i] = 0;
    if (spots.merged[i] != 0) continue;
    const CudaSquare<Pixel> square{settings.options, grey, spots.middle_x[i], spots.middle_y[i],
                                   pixels_of_others(maxima, grey.height(), settings, spots, i)};
    const float dark = grey.dark(grey.index(spots.middle_x[i], spots.middle_y[i]));
    std::uint32_t lit = 0;
    float usable = 0;
    each_pixel(settings.options, [&](std::size_t k, float, float) {
      const auto at = square.place(k);
      lit += at.own && grey.over(at.index) > dark, usable += square.usable(k);
    });
    if (lit < settings.min_area_px) {
      atomicAdd(&counts->too_small, 1ULL);
      continue;
    }
    float light = 0;
    const SpotCentre<float> centre = find_centre(square, light);
    spots.x[i] = centre.x, spots.y[i] = centre.y, spots.variance[i] = centre.variance;
    spots.grey[i] = light, spots.area[i] = static_cast<float>(lit);
    spots.kept[i] = spots.place[i] = 1;
    if (usable >= kFewestPixels) spots.plateau_rows[i] = 0;  // the fit knows better
  }
}

__global__ void write_detections(CudaMaxima maxima, std::uint32_t height, CudaSpots spots, CudaDetections out) {
  const std::uint32_t count = min(maxima.row_start[height], maxima.capacity);
  for (std::uint32_t i = cuda_item(); i < count; i += cuda_stride()) {
    const std::uint32_t at = spots.place[i];
    if (spots.kept[i] == 0 || at >= out.capacity) continue;
    double x = spots.middle_x[i] + static_cast<double>(spots.x[i]);
    double y = spots.middle_y[i] + static_cast<double>(spots.y[i]);
    float variance = spots.variance[i];
    if (spots.plateau_rows[i] > 0) {  // both ends of each row are known to a pixel
      x = spots.plateau_x[i], y = spots.plateau_y[i];
      variance = static_cast<float>(1 / (24 * spots.plateau_rows[i]));
    }
    out.x_px[at] = x, out.y_px[at] = y, out.sigma_px[at] = std::sqrt(static_cast<double>(variance));
    out.grey[at] = static_cast<double>(spots.grey[i]), out.area_px[at] = static_cast<double>(spots.area[i]);
  }
}

template <class Pixel>
bool find(const CudaImage& image, const CudaDark& dark, const CudaMaxima& maxima, const CudaSpotSettings& settings,
          const CudaSpots& spots, const CudaDetections& out, CudaSpotCounts* counts, void* stream,
          unsigned threads) noexcept {
  const CudaGrey<Pixel> grey{static_cast<const Pixel*>(image.pixels), dark, static_cast<std::int32_t>(image.width_px),
                             static_cast<std::int32_t>(image.height_px), settings.saturation_grey};
  const std::size_t most = maxima.capacity;
  return launch(place_squares<Pixel>, most, threads, stream, grey, maxima, spots) &&
         launch(drop_noise<Pixel>, most, threads, stream, grey, maxima, settings, spots, counts) &&
         launch(fit_spots<Pixel>, most, threads, stream, grey, maxima, settings, spots, counts) &&
         exclusive_scan_cuda(spots.place, most, maxima.row_start + image.height_px, out.count, stream, threads) &&
         launch(write_detections, most, threads, stream, maxima, image.height_px, spots, out);
}

}  // namespace

bool find_spots_cuda(const CudaImage& image, const CudaDark& dark, const CudaMaxima& maxima,
                     const CudaSpotSettings& settings, const CudaSpots& scratch, const CudaDetections& out,
                     CudaSpotCounts* counts, void* stream, unsigned threads_per_block) noexcept {
  return image.bytes_per_pixel == 1
             ? find<std::uint8_t>(image, dark, maxima, settings, scratch, out, counts, stream, threads_per_block)
             : find<std::uint16_t>(image, dark, maxima, settings, scratch, out, counts, stream, threads_per_block);
}

}  // namespace rptv
