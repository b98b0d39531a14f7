// SPDX-License-Identifier: MIT
// Raster order by a prefix sum over rows: no append by atomics, whose order would be free, and no sort after it.
#include "reconstruct/detection/lit_maxima_cuda.hpp"

#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/cuda_scan.hpp"
#include "reconstruct/detection/lit_maximum_kernel.hpp"

namespace rptv {

namespace {

// visit(x, lanes, found) for each 32 pixels of the row `y`: lanes with a maximum, and whether this one has.
template <class Pixel, class Visit>
__device__ void each_maximum(const CudaImage& image, const CudaDark& dark, std::uint32_t y, const Visit& visit) {
  const std::uint32_t width = image.width_px;
  const Pixel* row = static_cast<const Pixel*>(image.pixels) + std::size_t{y} * width;
  const std::uint16_t* limit = dark.limit + (dark.uniform ? 0 : std::size_t{y} * width);
  const bool inner = y > 0 && y + 1 < image.height_px;
  for (std::uint32_t first = 0; first < width; first += kWarp) {
    const std::uint32_t x = first + cuda_lane();
    const bool found = inner && x > 0 && x + 1 < width && row[x] > limit[dark.uniform ? 0 : x] &&
                       is_maximum(row + x, static_cast<std::ptrdiff_t>(width));
    visit(x, __ballot_sync(kAllLanes, found), found);
  }
}

template <class Pixel>
__global__ void count_maxima(CudaImage image, CudaDark dark, std::uint32_t* row_start) {
  for (std::uint32_t y = cuda_item() / kWarp; y < image.height_px; y += cuda_stride() / kWarp) {
    std::uint32_t count = 0;
    each_maximum<Pixel>(image, dark, y, [&](std::uint32_t, std::uint32_t lanes, bool) { count += __popc(lanes); });
    if (cuda_lane() == 0) row_start[y] = count;
  }
}

template <class Pixel>
__global__ void write_maxima(CudaImage image, CudaDark dark, CudaMaxima out) {
  for (std::uint32_t y = cuda_item() / kWarp; y < image.height_px; y += cuda_stride() / kWarp) {
    std::uint32_t next = out.row_start[y];
    if (out.row_start[y + 1] == next) continue;
    each_maximum<Pixel>(image, dark, y, [&](std::uint32_t x, std::uint32_t lanes, bool found) {
      const std::uint32_t at = next + lanes_before(lanes);
      if (found && at < out.capacity)
        out.x[at] = static_cast<std::int32_t>(x), out.y[at] = static_cast<std::int32_t>(y);
      next += __popc(lanes);
    });
  }
}

template <class Pixel>
bool find(const CudaImage& image, const CudaDark& dark, const CudaMaxima& out, void* stream,
          unsigned threads) noexcept {
  const std::size_t all = std::size_t{image.height_px} * kWarp;
  return launch(count_maxima<Pixel>, all, threads, stream, image, dark, out.row_start) &&
         exclusive_scan_cuda(out.row_start, image.height_px, nullptr, out.row_start + image.height_px, stream,
                             threads) &&
         launch(write_maxima<Pixel>, all, threads, stream, image, dark, out);
}

}  // namespace

bool find_lit_maxima_cuda(const CudaImage& image, const CudaDark& dark, const CudaMaxima& out, void* stream,
                          unsigned threads_per_block) noexcept {
  return image.bytes_per_pixel == 1 ? find<std::uint8_t>(image, dark, out, stream, threads_per_block)
                                    : find<std::uint16_t>(image, dark, out, stream, threads_per_block);
}

}  // namespace rptv
