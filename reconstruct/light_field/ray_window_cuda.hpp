// SPDX-License-Identifier: MIT
// A warp looks at the rays that may pass near a point. For CUDA sources only.
#pragma once

#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/light_field/ray_window_kernel.hpp"
#include "reconstruct/light_field/rays_cuda.hpp"

namespace rptv {

/// visit(ray, whether it is one) for the rays that may pass within `reach_mm`, 32 at once, in ascending order: all
/// lanes of the warp call it together, so it may vote.
template <class Visit>
__device__ void visit_near(const RayWindowKernel& window, const CudaRays& rays, const ImagePoint& at, double reach_mm,
                           const Visit& visit) {
  const LensletBlock block = window.block_near(at, reach_mm);
  for (std::uint32_t row = block.first_row; row < block.end_row; ++row) {
    const std::uint32_t last = rays.first_of_lenslet[window.last_lenslet(block, row) + 1];
    for (std::uint32_t ray = rays.first_of_lenslet[window.first_lenslet(block, row)]; ray < last; ray += kWarp)
      if (!visit(ray + cuda_lane(), ray + cuda_lane() < last)) return;
  }
}

}  // namespace rptv
