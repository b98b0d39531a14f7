// SPDX-License-Identifier: MIT
// A counting sort of one view's detections by their epipolar line, and a thread a ray of the other view.
#include "reconstruct/multi_view/view_pairs_cuda.hpp"

#include "reconstruct/cuda_bin_sort.hpp"
#include "reconstruct/multi_view/asked_place_kernel.hpp"

namespace rptv {

namespace {

// A detection's bin in the pencil.
struct LineBinOf {
  CudaSeen seen;
  PencilOfLines lines;
  PencilBins bins;
  __device__ std::uint32_t operator()(std::uint32_t i) const {
    return seen.u[i] == seen.u[i] ? bins.of(lines.of({seen.u[i], seen.v[i], 1})) : kNoBin;
  }
};

// Where refraction makes rays wander in the pinhole image, they are asked themselves.
__device__ bool meets(const CudaPairSearch& search, const Sight& sight, std::uint32_t detection, double& t) {
  Point3 from_mm, along;
  const SeenRay& ray = search.second.ray[detection];
  sight_along(ray, search.second_axes, from_mm, along);
  t = nearest_depth(sight, from_mm, along);
  const auto miss = miss_px(ray, search.second_axes, sight.from_mm + t * sight.along);
  return miss[0] * miss[0] + miss[1] * miss[1] <= search.error_px * search.error_px;
}

__device__ void append(const CudaPairs& out, std::uint32_t first, std::uint32_t second, double depth_mm) {
  const std::uint32_t at = atomicAdd(out.count, 1U);
  if (at < out.capacity) out.first[at] = first, out.second[at] = second, out.depth_mm[at] = depth_mm;
}

__global__ void follow_rays(CudaPairSearch search, CudaBins pencil, CudaPairs out) {
  const PencilBins bins(search.lines, search.second.count);
  const double reach_px = search.error_px + search.wander_px;
  for (std::uint32_t i = cuda_item(); i < search.first.count; i += cuda_stride()) {
    if (search.first.u[i] != search.first.u[i] || search.first.settled[i] != 0) continue;
    Sight sight;
    sight_along(search.first.ray[i], search.first_axes, sight.from_mm, sight.along);
    if (!clip(search.half_mm, sight)) continue;
    unsigned long long near = 0;
    if (out.totals != nullptr) atomicAdd(&out.totals->rays, 1ULL);
    const EpipolarLine line(search.second_pinhole, sight);
    if (!line.in_front(sight)) continue;
    const LineInPencil found(search.lines, line, sight, reach_px);
    const std::uint32_t until = pencil.start[bins.of(found.high) + 1];
    for (std::uint32_t at = pencil.start[bins.of(found.low)]; at < until; ++at) {
      const std::uint32_t k = pencil.entry[at];
      const double u = search.second.u[k], v = search.second.v[k];
      if (!found.near(u, v, reach_px)) continue;
      double t = found.major == 0 ? line.depth(0, u) : line.depth(1, v);
      if (!found.in_depths(t, sight)) continue;
      ++near;
      if (search.second.settled[k] != 0) continue;
      if (search.wander_px <= kNoWander_px || meets(search, sight, k, t)) append(out, i, k, t);
    }
    if (out.totals != nullptr) atomicAdd(&out.totals->pairs, near);
  }
}

}  // namespace

bool find_pairs_cuda(const CudaPairSearch& search, const CudaBins& scratch, const CudaPairs& out, void* stream,
                     unsigned threads_per_block) noexcept {
  const PencilBins bins(search.lines, search.second.count);
  return cudaMemsetAsync(out.count, 0, sizeof(std::uint32_t), static_cast<cudaStream_t>(stream)) == cudaSuccess &&
         sort_into_bins(LineBinOf{search.second, search.lines, bins}, search.second.count, bins.bins, scratch, stream,
                        threads_per_block) &&
         launch(follow_rays, search.first.count, threads_per_block, stream, search, scratch, out);
}

}  // namespace rptv
