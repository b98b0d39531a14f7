// SPDX-License-Identifier: MIT
// Lit pixels and their rays on the device: the threshold, eq. (5), and rays sorted by lenslet.
#pragma once

#include "reconstruct/detection/image_cuda.hpp"
#include "reconstruct/light_field/pixels_to_rays_kernel.hpp"
#include "reconstruct/light_field/rays_cuda.hpp"

namespace rptv {

/// Indices of lit pixels, ascending, of which the first `capacity` are written; *size counts all.
struct CudaLitPixels {
  std::uint32_t* pixel;       ///< capacity
  std::uint32_t* size;        ///< one
  std::uint32_t* run_memory;  ///< compact_runs(pixels of the image)
  std::uint32_t capacity;
};

/// What PixelsToRays knows, on the device.
struct CudaRayTable {
  const std::uint32_t* lenslets;  ///< [pixel][hypothesis], LensletLattice::kNone fills up
  const float* centre_mm;         ///< [lenslet][x, y]
  PixelOptics optics;
  std::uint32_t hypotheses, width_px;
};

/// Work memory of the sort.
struct CudaRaySort {
  std::uint32_t* first_ray;  ///< of a lit pixel; capacity of the lit pixels
  std::uint32_t* place;      ///< of a ray, in the order of pixels; capacity of the rays
  std::uint32_t* pixel;      ///< lit pixel in each place before sorting; capacity of the rays
  std::uint32_t* lenslet;    ///< of each place; capacity of the rays
  std::uint32_t* filled;     ///< places of a lenslet; lenslets
};

/// Queues find_lit_pixels() on `stream` (a cudaStream_t): the same pixels, in the same order. False when the runtime
/// refuses. `threads_per_block`, here and below: a multiple of 32.
bool find_lit_pixels_cuda(const CudaImage& image, const CudaDark& dark, const CudaLitPixels& out, void* stream,
                          unsigned threads_per_block = 256) noexcept;

/// Queues PixelsToRays::convert() for the lit pixels that were written: the same rays in the same order, bit for bit,
/// and as many pixels left out (`size` of `lit` less *out.pixels).
bool pixels_to_rays_cuda(const CudaLitPixels& lit, const CudaRayTable& table, const CudaRaySort& work,
                         const CudaRays& out, void* stream, unsigned threads_per_block = 256) noexcept;

}  // namespace rptv
