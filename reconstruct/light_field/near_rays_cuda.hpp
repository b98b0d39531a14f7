// SPDX-License-Identifier: MIT
// Rays near a point on the device: a warp keeps and sums them, in the CPU's order. For CUDA sources only.
#pragma once

#include "reconstruct/light_field/near_rays_kernel.hpp"
#include "reconstruct/light_field/ray_window_cuda.hpp"

namespace rptv {

constexpr unsigned kMostFitThreads = 256;  // of a block whose warps fit

/// Memory of the block in which warps add up.
struct WarpSums {
  float lane[kMostFitThreads / kWarp][2 * kWarp];
  double total[kMostFitThreads / kWarp][8];
};

/// Numbers of rays that a warp has gathered, for particle_fit_kernel.hpp. All lanes call together.
struct WarpNear {
  const CudaRays& rays;
  const RayGate& gate;
  std::uint32_t* number;  ///< capacity, on the device
  std::uint32_t capacity;
  WarpSums& sums;
  std::uint32_t size = 0;  ///< beyond the capacity: that many would have been gathered

  __device__ Ray ray(std::size_t i) const { return rays.ray[number[i]]; }

  /// Appends this lane's ray, where it is wanted, in the order of the lanes.
  __device__ void append(std::uint32_t i, bool wanted) {
    const std::uint32_t lanes = __ballot_sync(kAllLanes, wanted), at = size + lanes_before(lanes);
    if (wanted && at < capacity) number[at] = i;
    size += static_cast<std::uint32_t>(__popc(lanes));
  }
  __device__ void keep(const ImagePoint& at, double reach_mm) {
    const RaySearch search = search_of(gate, at, reach_mm);
    const std::uint32_t all = size;
    size = 0;
    for (std::uint32_t first = 0; first < all; first += kWarp) {
      const std::uint32_t k = first + cuda_lane(), i = k < all ? number[k] : 0;
      __syncwarp();  // what is overwritten has been read
      append(i, k < all && distance_mm(rays.ray[i], search) <= search.reach);
    }
    __syncwarp();
  }
  /// How many are within reach.
  __device__ std::uint32_t count(const ImagePoint& at, double reach_mm) const {
    const RaySearch search = search_of(gate, at, reach_mm);
    std::uint32_t found = 0;
    for (std::uint32_t first = 0; first < size; first += kWarp) {
      const std::uint32_t k = first + cuda_lane();
      const bool near = k < size && distance_mm(ray(k), search) <= search.reach;
      found += static_cast<std::uint32_t>(__popc(__ballot_sync(kAllLanes, near)));
    }
    return found;
  }
  /// sum_rays(), with its bits: eight partial sums each, two of the eight sums in every eight lanes.
  __device__ RaySums sum(const ImagePoint& at, double half_width_mm) const {
    const RaySearch search = search_of(gate, at, half_width_mm);
    const std::uint32_t lane = cuda_lane(), warp = threadIdx.x / kWarp, pair = lane / 8;
    float a = 0, b = 0;
    for (std::uint32_t k = lane % 8; k < size; k += 8) {
      const Ray one = ray(k);
      if (!(distance_mm(one, search) <= search.reach)) continue;
      const float s_x = one.slope_x, s_y = one.slope_y;
      const float r_x = one.centre_x + s_x * search.z - search.x, r_y = one.centre_y + s_y * search.z - search.y;
      a += pair == 0 ? 1.0F : pair == 1 ? s_y : pair == 2 ? r_x : r_x * s_x + r_y * s_y;
      b += pair == 0 ? s_x : pair == 1 ? s_x * s_x + s_y * s_y : pair == 2 ? r_y : r_x * r_x + r_y * r_y;
    }
    __syncwarp();  // the sums before these have been read
    sums.lane[warp][lane] = a, sums.lane[warp][kWarp + lane] = b;
    __syncwarp();
    if (lane < 8) {
      double total = 0;
      for (std::uint32_t k = 0; k < 8; ++k)
        total += static_cast<double>(sums.lane[warp][(lane % 2) * kWarp + lane / 2 * 8 + k]);
      sums.total[warp][lane] = total;
    }
    __syncwarp();
    const double* t = sums.total[warp];
    RaySums all;
    all.w = t[0], all.ws_x = t[1], all.ws_y = t[2], all.wss = t[3];
    all.wr_x = t[4], all.wr_y = t[5], all.wrs = t[6], all.wrr = t[7];
    return all;
  }
};

}  // namespace rptv
