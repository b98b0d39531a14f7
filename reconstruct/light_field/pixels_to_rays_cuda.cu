// SPDX-License-Identifier: MIT
// The sort by lenslet: histogram, running sums, places in any order, then each ray's rank among those of its lenslet.
#include "reconstruct/light_field/pixels_to_rays_cuda.hpp"

#include "reconstruct/cuda_compact.hpp"

namespace rptv {

namespace {

constexpr std::uint32_t kNoLenslet = 0xffffffffU;

template <class Pixel>
struct IsLit {
  const Pixel* pixels;
  CudaDark dark;
  __device__ bool operator()(std::uint32_t i) const { return pixels[i] > dark.limit[dark.uniform ? 0 : i]; }
};

struct WriteIndex {
  std::uint32_t* out;
  __device__ void operator()(std::uint32_t at, std::uint32_t index) const { out[at] = index; }
};

/// Everything that the kernels below share.
struct Sort {
  CudaLitPixels lit;
  CudaRayTable table;
  CudaRaySort work;
  CudaRays rays;

  __device__ std::uint32_t lit_count() const { return min(*lit.size, lit.capacity); }
  __device__ const std::uint32_t* lenslets_of(std::uint32_t p) const {
    return table.lenslets + static_cast<std::size_t>(lit.pixel[p]) * table.hypotheses;
  }
  __device__ std::uint32_t rays_of(std::uint32_t p) const {
    const std::uint32_t* lenslets = lenslets_of(p);
    std::uint32_t count = 0;
    while (count < table.hypotheses && lenslets[count] != kNoLenslet) ++count;
    return count;
  }
  // There is room for all hypotheses of this pixel: so there is for those before it.
  __device__ bool fits(std::uint32_t p) const {
    return p < rays.capacity && work.first_ray[p] + table.hypotheses <= rays.capacity;
  }
};

__global__ void count_rays_of_pixels(Sort sort) {
  const std::uint32_t lit = sort.lit_count();
  for (std::uint32_t p = cuda_item(); p < lit; p += cuda_stride()) sort.work.first_ray[p] = sort.rays_of(p);
}

__global__ void count_rays_of_lenslets(Sort sort) {
  const std::uint32_t lit = sort.lit_count();
  for (std::uint32_t p = cuda_item(); p < lit; p += cuda_stride()) {
    if (!sort.fits(p)) continue;
    const std::uint32_t* lenslets = sort.lenslets_of(p);
    const std::uint32_t count = sort.rays_of(p);
    for (std::uint32_t k = 0; k < count; ++k) atomicAdd(&sort.rays.first_of_lenslet[lenslets[k]], 1U);
    if (p + 1 == lit || !sort.fits(p + 1)) *sort.rays.pixels = p + 1;
  }
}

__global__ void place_rays(Sort sort) {
  const std::uint32_t pixels = *sort.rays.pixels;
  for (std::uint32_t p = cuda_item(); p < pixels; p += cuda_stride()) {
    const std::uint32_t* lenslets = sort.lenslets_of(p);
    const std::uint32_t count = sort.rays_of(p);
    for (std::uint32_t k = 0; k < count; ++k) {
      const std::uint32_t place =
          sort.rays.first_of_lenslet[lenslets[k]] + atomicAdd(&sort.work.filled[lenslets[k]], 1U);
      sort.work.pixel[place] = p, sort.work.lenslet[place] = lenslets[k];
    }
  }
}

// Within a lenslet rays are in the order of their pixels, of which it has few.
__global__ void rank_rays(Sort sort) {
  const std::uint32_t rays = *sort.rays.size;
  for (std::uint32_t place = cuda_item(); place < rays; place += cuda_stride()) {
    const std::uint32_t p = sort.work.pixel[place], lenslet = sort.work.lenslet[place];
    const std::uint32_t first = sort.rays.first_of_lenslet[lenslet], last = sort.rays.first_of_lenslet[lenslet + 1];
    std::uint32_t at = first;
    for (std::uint32_t i = first; i < last; ++i) at += sort.work.pixel[i] < p;
    const std::uint32_t pixel = sort.lit.pixel[p], *lenslets = sort.lenslets_of(p);
    std::uint32_t hypothesis = 0;
    while (lenslets[hypothesis] != lenslet) ++hypothesis;
    const float* centre = sort.table.centre_mm + 2 * static_cast<std::size_t>(lenslet);
    sort.rays.ray[at] =
        ray_of(sort.table.optics, pixel % sort.table.width_px, pixel / sort.table.width_px, centre[0], centre[1]);
    sort.rays.pixel[at] = p;
    sort.work.place[sort.work.first_ray[p] + hypothesis] = at;
  }
}

__global__ void join_rays_of_pixels(Sort sort) {
  const std::uint32_t pixels = *sort.rays.pixels;
  for (std::uint32_t p = cuda_item(); p < pixels; p += cuda_stride()) {
    const std::uint32_t count = sort.rays_of(p), *place = sort.work.place + sort.work.first_ray[p];
    for (std::uint32_t k = 0; k < count; ++k) sort.rays.same_pixel[place[k]] = place[k + 1 < count ? k + 1 : 0];
  }
}

template <class Pixel>
bool find_lit(const CudaImage& image, const CudaDark& dark, const CudaLitPixels& out, void* stream,
              unsigned threads) noexcept {
  return compact_cuda(IsLit<Pixel>{static_cast<const Pixel*>(image.pixels), dark}, WriteIndex{out.pixel},
                      std::size_t{image.width_px} * image.height_px, out.run_memory, out.size, out.capacity, stream,
                      threads);
}

bool clear(std::uint32_t* values, std::size_t count, void* stream) noexcept {
  return cudaMemsetAsync(values, 0, count * sizeof(std::uint32_t), static_cast<cudaStream_t>(stream)) == cudaSuccess;
}

}  // namespace

bool find_lit_pixels_cuda(const CudaImage& image, const CudaDark& dark, const CudaLitPixels& out, void* stream,
                          unsigned threads_per_block) noexcept {
  return image.bytes_per_pixel == 1 ? find_lit<std::uint8_t>(image, dark, out, stream, threads_per_block)
                                    : find_lit<std::uint16_t>(image, dark, out, stream, threads_per_block);
}

bool pixels_to_rays_cuda(const CudaLitPixels& lit, const CudaRayTable& table, const CudaRaySort& work,
                         const CudaRays& out, void* stream, unsigned threads_per_block) noexcept {
  const Sort sort{lit, table, work, out};
  const std::size_t lenslets = out.lenslets;
  return clear(out.pixels, 1, stream) && clear(out.first_of_lenslet, lenslets + 1, stream) &&
         clear(work.filled, lenslets, stream) &&
         launch(count_rays_of_pixels, lit.capacity, threads_per_block, stream, sort) &&
         exclusive_scan_cuda(work.first_ray, lit.capacity, lit.size, out.size, stream, threads_per_block) &&
         launch(count_rays_of_lenslets, lit.capacity, threads_per_block, stream, sort) &&
         exclusive_scan_cuda(out.first_of_lenslet, lenslets + 1, nullptr, out.size, stream, threads_per_block) &&
         launch(place_rays, lit.capacity, threads_per_block, stream, sort) &&
         launch(rank_rays, out.capacity, threads_per_block, stream, sort) &&
         launch(join_rays_of_pixels, lit.capacity, threads_per_block, stream, sort);
}

}  // namespace rptv
