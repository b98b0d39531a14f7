// SPDX-License-Identifier: MIT
// Rays in chunks with bounds, then tiles of shared counters over those chunks that can meet them.
#include "reconstruct/light_field/ray_count_cuda.hpp"

#include <algorithm>

#include "reconstruct/cuda_launch.hpp"

namespace rptv {

namespace {

constexpr std::int32_t kTileCounters = 48 * 1024 / 4, kTileWidth = 2048;
constexpr std::int32_t kManyBlocks = 512;  // from which more tiles would only read rays more often
constexpr std::int32_t kLeastRows = 8;
constexpr std::uint32_t kMostCount = 65535;

/// How planes are cut: tiles of width·height counters, border included, `across`·`down` of them.
struct Tiles {
  std::int32_t width, height, across, down;
};

Tiles tiles_of(const VoxelGrid& grid) {
  const std::int32_t width = std::min(grid.stride(), kTileWidth), rows = grid.size_y + 2;
  const std::int32_t per_plane = (kManyBlocks + grid.planes - 1) / grid.planes;
  const std::int32_t height =
      std::min({rows, kTileCounters / width, std::max(kLeastRows, (rows + per_plane - 1) / per_plane)});
  return {width, height, (grid.stride() + width - 1) / width, (rows + height - 1) / height};
}

/// Ends of a range. What is no number is nowhere, so that its chunk is looked at everywhere.
struct Range {
  float low = INFINITY, high = -INFINITY;

  __device__ void add(float value) {
    low = value == value ? fminf(low, value) : -INFINITY;
    high = value == value ? fmaxf(high, value) : INFINITY;
  }
  __device__ void join_warp() {
    for (unsigned step = kWarp / 2; step > 0; step /= 2) {
      low = fminf(low, __shfl_xor_sync(kAllLanes, low, step));
      high = fmaxf(high, __shfl_xor_sync(kAllLanes, high, step));
    }
  }
};

// A warp a chunk: its free rays in units of voxels, moved together.
__global__ void make_chunks(VoxelGrid grid, CudaRays rays, const std::uint8_t* taken, CudaRayCount out) {
  const std::uint32_t size = *rays.size, chunks = (size + RayChunk::kRays - 1) / RayChunk::kRays;
  for (std::uint32_t chunk = cuda_item() / kWarp; chunk < chunks; chunk += cuda_stride() / kWarp) {
    const std::uint32_t first = chunk * RayChunk::kRays;
    Range column, row, column_slope, row_slope;
    std::uint32_t found = 0;
    for (std::uint32_t i = first + cuda_lane(); i < first + RayChunk::kRays; i += kWarp) {
      const bool free = i < size && (taken == nullptr || taken[i] == 0);
      const std::uint32_t lanes = __ballot_sync(kAllLanes, free);
      if (free) {
        const VoxelRay ray = to_voxels(grid, rays.ray[i]);
        out.rays[first + found + lanes_before(lanes)] = ray;
        column.add(ray.column), row.add(ray.row), column_slope.add(ray.column_slope), row_slope.add(ray.row_slope);
      }
      found += static_cast<std::uint32_t>(__popc(lanes));
    }
    column.join_warp(), row.join_warp(), column_slope.join_warp(), row_slope.join_warp();
    if (cuda_lane() == 0)
      out.chunks[chunk] = {column.low,        column.high,    column_slope.low,
                           column_slope.high, row.low,        row.high,
                           row_slope.low,     row_slope.high, found};
  }
}

// Whether rays within the bounds can be in voxels first … end - 1 of an axis: rounding and fmaf() keep order, so that
// the bounds' voxels bound the rays' voxels exactly. A bound that is no number excludes nothing.
__device__ bool may_meet(float low, float high, float low_slope, float high_slope, float z_mm, std::int32_t size,
                         std::int32_t first, std::int32_t end) {
  const float low_at = fmaf(z_mm < 0 ? high_slope : low_slope, z_mm, low);
  const float high_at = fmaf(z_mm < 0 ? low_slope : high_slope, z_mm, high);
  if (!(low_at > -INFINITY && high_at < INFINITY)) return true;
  return nearest_voxel(low_at, 0, 0, size) < end && nearest_voxel(high_at, 0, 0, size) >= first;
}

// A block a tile, a warp a chunk.
__global__ void count_tiles(VoxelGrid grid, Tiles tiles, const std::uint32_t* ray_count, CudaRayCount out) {
  RPTV_DYNAMIC_SHARED(std::uint32_t, counters);
  const auto block = static_cast<std::int32_t>(blockIdx.x);
  const std::int32_t plane = block / (tiles.across * tiles.down), tile = block % (tiles.across * tiles.down);
  const std::int32_t first_x = tile % tiles.across * tiles.width, first_y = tile / tiles.across * tiles.height;
  const std::int32_t end_x = min(first_x + tiles.width, grid.stride());
  const std::int32_t end_y = min(first_y + tiles.height, grid.size_y + 2);
  const auto counter_count = static_cast<std::uint32_t>(tiles.width * (end_y - first_y));
  for (std::uint32_t i = threadIdx.x; i < counter_count; i += blockDim.x) counters[i] = 0;
  __syncthreads();
  const float z_mm = grid.z_mm(plane);
  const std::uint32_t chunks = (*ray_count + RayChunk::kRays - 1) / RayChunk::kRays;
  for (std::uint32_t c = threadIdx.x / kWarp; c < chunks; c += blockDim.x / kWarp) {
    const RayChunk chunk = out.chunks[c];
    if (!may_meet(chunk.low_row, chunk.high_row, chunk.low_row_slope, chunk.high_row_slope, z_mm, grid.size_y, first_y,
                  end_y) ||
        !may_meet(chunk.low_column, chunk.high_column, chunk.low_column_slope, chunk.high_column_slope, z_mm,
                  grid.size_x, first_x, end_x))
      continue;
    for (std::uint32_t i = cuda_lane(); i < chunk.size; i += kWarp) {
      const VoxelRay ray = out.rays[c * RayChunk::kRays + i];
      const std::int32_t x = nearest_voxel(ray.column, ray.column_slope, z_mm, grid.size_x);
      const std::int32_t y = nearest_voxel(ray.row, ray.row_slope, z_mm, grid.size_y);
      if (x >= first_x && x < end_x && y >= first_y && y < end_y)
        atomicAdd(&counters[(y - first_y) * tiles.width + x - first_x], 1U);
    }
  }
  __syncthreads();
  std::uint16_t* counts = out.counts + static_cast<std::size_t>(plane) * static_cast<std::size_t>(grid.plane_size());
  for (std::uint32_t i = threadIdx.x; i < counter_count; i += blockDim.x) {
    const std::int32_t x = first_x + static_cast<std::int32_t>(i) % tiles.width;
    const std::int32_t y = first_y + static_cast<std::int32_t>(i) / tiles.width;
    if (x < end_x) counts[grid.index(x, y)] = static_cast<std::uint16_t>(min(counters[i], kMostCount));
  }
}

}  // namespace

bool count_rays_cuda(const VoxelGrid& grid, const CudaRays& rays, const std::uint8_t* taken, const CudaRayCount& out,
                     void* stream, unsigned threads_per_block) noexcept {
  const Tiles tiles = tiles_of(grid);
  const auto blocks = static_cast<std::size_t>(tiles.across * tiles.down) * static_cast<std::size_t>(grid.planes);
  const std::size_t shared_bytes = static_cast<std::size_t>(tiles.width * tiles.height) * sizeof(std::uint32_t);
  return launch(make_chunks, ray_chunks(rays.capacity) * kWarp, threads_per_block, stream, grid, rays, taken, out) &&
         launch_blocks(count_tiles, blocks, threads_per_block, shared_bytes, stream, grid, tiles,
                       static_cast<const std::uint32_t*>(rays.size), out);
}

}  // namespace rptv
