// SPDX-License-Identifier: MIT
// Smoothing, the highest of each neighbourhood, and those voxels that are maxima, a thread a voxel.
#include "reconstruct/light_field/coarse_maxima_cuda.hpp"

#include "reconstruct/cuda_compact.hpp"

namespace rptv {

namespace {

/// The counter and what is made of it, by index over all planes.
struct Volume {
  VoxelGrid grid;
  const std::uint16_t* counts;
  std::uint16_t *smooth, *highest;
  std::uint16_t least, bound;

  __host__ __device__ std::uint32_t plane_size() const { return static_cast<std::uint32_t>(grid.plane_size()); }
  __host__ __device__ std::uint32_t size() const { return plane_size() * static_cast<std::uint32_t>(grid.planes); }
  __device__ std::int32_t x_of(std::uint32_t i) const {
    return static_cast<std::int32_t>(i % plane_size() % static_cast<std::uint32_t>(grid.stride()));
  }
  __device__ std::int32_t y_of(std::uint32_t i) const {
    return static_cast<std::int32_t>(i % plane_size() / static_cast<std::uint32_t>(grid.stride()));
  }
  __device__ bool inner(std::int32_t x, std::int32_t y) const {
    return x >= 1 && y >= 1 && x <= grid.size_x && y <= grid.size_y;
  }

  // Whether the voxel is the highest of its neighbours; among equals the first in raster order is.
  __device__ bool is_maximum(std::uint32_t i) const {
    const std::uint32_t plane = plane_size(), stride = static_cast<std::uint32_t>(grid.stride());
    const std::uint16_t self = smooth[i];
    if (self < bound || self != highest[i]) return false;
    if (i >= plane && highest[i - plane] >= self) return false;
    if (i + plane < size() && highest[i + plane] > self) return false;
    return smooth[i - 1] != self && smooth[i - stride - 1] != self && smooth[i - stride] != self &&
           smooth[i - stride + 1] != self;
  }
  __device__ Candidate candidate(std::uint32_t i) const {
    const std::uint32_t plane = plane_size();
    const double offset =
        i < plane || i + plane >= size() ? 0 : depth_offset_of(highest[i - plane], highest[i], highest[i + plane]);
    const auto count = [this](std::int32_t x, std::int32_t y, std::int32_t z) {
      return counts[static_cast<std::size_t>(z) * plane_size() + static_cast<std::size_t>(grid.index(x, y))];
    };
    return candidate_at(grid, count, x_of(i), y_of(i), static_cast<double>(i / plane) + offset);
  }
};

// Weights 1-2-1 along x and y over inner voxels; zero on the border.
__global__ void smooth_counts(Volume volume) {
  for (std::uint32_t i = cuda_item(); i < volume.size(); i += cuda_stride()) {
    const std::int32_t x = volume.x_of(i), y = volume.y_of(i);
    std::uint32_t sum = 0;
    if (volume.inner(x, y))
      for (std::int32_t b = -1; b <= 1; ++b)
        for (std::int32_t a = -1; a <= 1; ++a) {
          if (!volume.inner(x + a, y + b)) continue;
          const std::uint32_t count = volume.counts[i + static_cast<std::uint32_t>(b * volume.grid.stride() + a)];
          const std::uint32_t weight = (a == 0 ? 2U : 1U) * (b == 0 ? 2U : 1U);
          sum += weight * (count < kMostSmoothable ? count : kMostSmoothable);
        }
    volume.smooth[i] = static_cast<std::uint16_t>(sum);
  }
}

// The highest of the 3×3 round each inner voxel.
__global__ void find_highest(Volume volume) {
  for (std::uint32_t i = cuda_item(); i < volume.size(); i += cuda_stride()) {
    std::uint16_t highest = 0;
    if (volume.inner(volume.x_of(i), volume.y_of(i)))
      for (std::int32_t b = -1; b <= 1; ++b)
        for (std::int32_t a = -1; a <= 1; ++a) {
          const std::uint16_t value = volume.smooth[i + static_cast<std::uint32_t>(b * volume.grid.stride() + a)];
          highest = value > highest ? value : highest;
        }
    volume.highest[i] = highest;
  }
}

struct IsCandidate {
  Volume volume;
  __device__ bool operator()(std::uint32_t i) const {
    return volume.is_maximum(i) && volume.candidate(i).rays >= volume.least;
  }
};

struct WriteCandidate {
  Volume volume;
  Candidate* out;
  __device__ void operator()(std::uint32_t at, std::uint32_t i) const { out[at] = volume.candidate(i); }
};

}  // namespace

bool find_coarse_maxima_cuda(const VoxelGrid& grid, const std::uint16_t* counts, std::uint16_t least,
                             const CudaCandidates& out, void* stream, unsigned threads_per_block) noexcept {
  const Volume volume{grid, counts, out.smooth, out.highest, least, smoothed_bound(least)};
  return launch(smooth_counts, volume.size(), threads_per_block, stream, volume) &&
         launch(find_highest, volume.size(), threads_per_block, stream, volume) &&
         compact_cuda(IsCandidate{volume}, WriteCandidate{volume, out.candidate}, volume.size(), out.run_memory,
                      out.size, out.capacity, stream, threads_per_block);
}

}  // namespace rptv
