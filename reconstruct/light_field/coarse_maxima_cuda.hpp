// SPDX-License-Identifier: MIT
// Candidates of the coarse count on the device.
#pragma once

#include "reconstruct/light_field/coarse_maxima_kernel.hpp"

namespace rptv {

/// Device memory of the search; candidates are the result, in raster order, of which the first `capacity` are written;
/// *size counts all.
struct CudaCandidates {
  Candidate* candidate;  ///< capacity
  std::uint32_t* size;   ///< one
  std::uint32_t capacity;
  std::uint16_t *smooth, *highest;  ///< planes·grid.plane_size() each
  std::uint32_t* run_memory;        ///< compact_runs(planes·grid.plane_size())
};

/// Queues CoarseMaxima::find() over the counter `counts` (planes·grid.plane_size() on the device, border included) on
/// `stream` (a cudaStream_t): the same candidates in the same order, bit for bit. `threads_per_block`: a multiple of
/// 32. False when the runtime refuses.
bool find_coarse_maxima_cuda(const VoxelGrid& grid, const std::uint16_t* counts, std::uint16_t least,
                             const CudaCandidates& out, void* stream, unsigned threads_per_block = 256) noexcept;

}  // namespace rptv
