// SPDX-License-Identifier: MIT
// A thread a tuple projects its point back into its views.
#include "reconstruct/multi_view/judge_tuples_cuda.hpp"

#include "reconstruct/cuda_launch.hpp"
#include "reconstruct/multi_view/asked_place_kernel.hpp"

namespace rptv {

namespace {

__device__ std::uint32_t detection_of(const CudaTuples& tuples, std::uint32_t view, std::uint32_t i) {
  return tuples.detection[std::size_t{view} * tuples.capacity + i];
}

// Copies tuple i of `from` behind `to`, where there is room, without the view `but`.
__device__ std::uint32_t append(const CudaTuples& from, std::uint32_t i, std::uint32_t but, const CudaTuples& to) {
  const std::uint32_t at = atomicAdd(to.count, 1U);
  for (std::uint32_t v = 0; v < from.views && at < to.capacity; ++v)
    to.detection[std::size_t{v} * to.capacity + at] = v == but ? kNoDetection : detection_of(from, v, i);
  return at;
}

struct Judgement {
  double square_px2, worst_px;
  std::uint32_t worst_view, views;
};

__device__ Judgement judge(const CudaViews& views, const CudaTuples& tuples, std::uint32_t i, const Point3& at_mm) {
  Judgement found{0, 0, 0, 0};
  double worst = 0;
  for (std::uint32_t v = 0; v < views.views; ++v) {
    const std::uint32_t detection = detection_of(tuples, v, i);
    if (detection == kNoDetection) continue;
    ++found.views;
    const auto miss =
        miss_px(views.ray[std::size_t{v} * views.max_detections + detection], views.geometry[v].axes, at_mm);
    const double square = miss[0] * miss[0] + miss[1] * miss[1];
    found.square_px2 += square;
    if (square > worst) worst = square, found.worst_view = v;
  }
  found.worst_px = std::isfinite(found.square_px2) ? sqrt(worst) : HUGE_VAL;
  return found;
}

__global__ void judge_tuples(CudaViews views, CudaTuples tuples, CudaPoints points, CudaJudging judging,
                             CudaMatches matches, CudaTuples doubtful) {
  constexpr std::uint32_t kNoView = kCudaMaxViews;
  const std::uint32_t count = min(*tuples.count, tuples.capacity);
  for (std::uint32_t i = cuda_item(); i < count; i += cuda_stride()) {
    const Point3 at{judging.scale_mm * points.x[i], judging.scale_mm * points.y[i], judging.scale_mm * points.z[i]};
    const Judgement found = judge(views, tuples, i, at);
    if (found.worst_px <= judging.tolerance_px) {
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) inside = inside && std::abs(at[k]) <= judging.half_mm[k];
      if (!inside) continue;
      const std::uint32_t m = append(tuples, i, kNoView, matches.tuples);
      if (m >= matches.tuples.capacity) continue;
      matches.x_mm[m] = at[0], matches.y_mm[m] = at[1], matches.z_mm[m] = at[2];
      matches.square_px2[m] = found.square_px2, matches.s[m] = points.s[i];
    } else if (found.views > judging.min_views) {
      for (std::uint32_t v = 0; v < views.views; ++v)
        if (detection_of(tuples, v, i) != kNoDetection &&
            (v == found.worst_view || found.views == judging.min_views + 1))
          append(tuples, i, v, doubtful);
    }
  }
}

__global__ void settle(CudaViews views, CudaMatches matches, double tolerance_px) {
  const CudaTuples& tuples = matches.tuples;
  const std::uint32_t count = min(*tuples.count, tuples.capacity);
  const std::uint32_t enough = min(views.views, static_cast<std::uint32_t>(kEnoughViews));
  const double square_px2 = tolerance_px * tolerance_px / 4;  // of a view, on average
  for (std::uint32_t m = cuda_item(); m < count; m += cuda_stride()) {
    std::uint32_t seen = 0;
    for (std::uint32_t v = 0; v < views.views; ++v) seen += detection_of(tuples, v, m) != kNoDetection;
    if (seen < enough || matches.square_px2[m] > seen * square_px2) continue;
    for (std::uint32_t v = 0; v < views.views; ++v)
      if (const std::uint32_t detection = detection_of(tuples, v, m); detection != kNoDetection)
        atomicExch(&views.settled[std::size_t{v} * views.max_detections + detection], 1U);
  }
}

__global__ void list_remains(CudaMatches matches, const std::uint32_t* chosen, const std::uint32_t* used,
                             std::uint32_t max_detections, std::uint32_t min_views, CudaTuples out) {
  const CudaTuples& tuples = matches.tuples;
  const std::uint32_t count = min(*tuples.count, tuples.capacity);
  for (std::uint32_t m = cuda_item(); m < count; m += cuda_stride()) {
    if (chosen[m] != 0) continue;
    std::uint32_t seen = 0, left = 0;
    for (std::uint32_t v = 0; v < tuples.views; ++v)
      if (const std::uint32_t detection = detection_of(tuples, v, m); detection != kNoDetection)
        ++seen, left += used[std::size_t{v} * max_detections + detection] == 0;
    if (left < min_views || left == seen) continue;
    const std::uint32_t at = atomicAdd(out.count, 1U);
    for (std::uint32_t v = 0; v < tuples.views && at < out.capacity; ++v) {
      const std::uint32_t detection = detection_of(tuples, v, m);
      const bool free = detection != kNoDetection && used[std::size_t{v} * max_detections + detection] == 0;
      out.detection[std::size_t{v} * out.capacity + at] = free ? detection : kNoDetection;
    }
  }
}

__global__ void pack_chosen(CudaMatches matches, const std::uint32_t* chosen, CudaChosen* out, std::uint32_t* count,
                            std::uint32_t capacity) {
  const CudaTuples& tuples = matches.tuples;
  const std::uint32_t all = min(*tuples.count, tuples.capacity);
  for (std::uint32_t m = cuda_item(); m < all; m += cuda_stride()) {
    if (chosen[m] == 0) continue;
    const std::uint32_t at = atomicAdd(count, 1U);
    if (at >= capacity) continue;
    for (std::uint32_t v = 0; v < kCudaMaxViews; ++v)
      out[at].detection[v] = v < tuples.views ? detection_of(tuples, v, m) : kNoDetection;
    out[at].at_mm[0] = matches.x_mm[m], out[at].at_mm[1] = matches.y_mm[m], out[at].at_mm[2] = matches.z_mm[m];
    out[at].square_px2 = matches.square_px2[m], out[at].s = matches.s[m];
  }
}

__global__ void end_list(std::uint32_t* count, std::uint32_t capacity, unsigned long long* refused) {
  if (*count > capacity) *refused += *count - capacity;
  *count = 0;
}

}  // namespace

bool judge_tuples_cuda(const CudaViews& views, const CudaTuples& tuples, const CudaPoints& points,
                       const CudaJudging& judging, const CudaMatches& matches, const CudaTuples& doubtful, void* stream,
                       unsigned threads_per_block) noexcept {
  return launch(judge_tuples, tuples.capacity, threads_per_block, stream, views, tuples, points, judging, matches,
                doubtful);
}

bool settle_cuda(const CudaViews& views, const CudaMatches& matches, double tolerance_px, void* stream,
                 unsigned threads_per_block) noexcept {
  return launch(settle, matches.tuples.capacity, threads_per_block, stream, views, matches, tolerance_px);
}

bool list_remains_cuda(const CudaMatches& matches, const std::uint32_t* chosen, const std::uint32_t* used,
                       std::uint32_t max_detections, std::uint32_t min_views, const CudaTuples& tuples, void* stream,
                       unsigned threads_per_block) noexcept {
  return launch(list_remains, matches.tuples.capacity, threads_per_block, stream, matches, chosen, used, max_detections,
                min_views, tuples);
}

bool end_list_cuda(std::uint32_t* count, std::uint32_t capacity, unsigned long long* refused, void* stream) noexcept {
  return launch(end_list, 1, 1, stream, count, capacity, refused);
}

bool pack_chosen_cuda(const CudaMatches& matches, const std::uint32_t* chosen, CudaChosen* out, std::uint32_t* count,
                      std::uint32_t capacity, void* stream, unsigned threads_per_block) noexcept {
  return launch(pack_chosen, matches.tuples.capacity, threads_per_block, stream, matches, chosen, out, count, capacity);
}

}  // namespace rptv
