// SPDX-License-Identifier: MIT
// The ray counter matrix of eq. (6) on the device: a block counts one tile of one plane in shared memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "reconstruct/light_field/ray_count_kernel.hpp"
#include "reconstruct/light_field/rays_cuda.hpp"

namespace rptv {

/// Neighbours in the order of lenslets, and where they are: at depth z between fmaf(slope, z, position) of the ends.
struct RayChunk {
  static constexpr std::uint32_t kRays = 256;
  float low_column, high_column, low_column_slope, high_column_slope;
  float low_row, high_row, low_row_slope, high_row_slope;
  std::uint32_t size;  ///< those of its kRays that are free
};

/// Device memory of the counter; `counts` is the result.
struct CudaRayCount {
  VoxelRay* rays;         ///< ray_chunks(capacity)·RayChunk::kRays
  RayChunk* chunks;       ///< ray_chunks(capacity)
  std::uint16_t* counts;  ///< planes·grid.plane_size(), border included
};

inline std::size_t ray_chunks(std::size_t capacity) { return (capacity + RayChunk::kRays - 1) / RayChunk::kRays; }

/// Queues the count on `stream` (a cudaStream_t): what RayCounter::count() counts, bit for bit. Rays with taken[ray]
/// not 0 are left out; `taken` may be null. `threads_per_block`: a multiple of 32. False when the runtime refuses.
bool count_rays_cuda(const VoxelGrid& grid, const CudaRays& rays, const std::uint8_t* taken, const CudaRayCount& out,
                     void* stream, unsigned threads_per_block = 512) noexcept;

}  // namespace rptv
