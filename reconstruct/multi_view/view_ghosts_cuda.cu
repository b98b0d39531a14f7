// SPDX-License-Identifier: MIT
// Rounds of one block: claim, take, drop.
#include "reconstruct/multi_view/view_ghosts_cuda.hpp"

#include "reconstruct/cuda_launch.hpp"

namespace rptv {

namespace {

constexpr std::uint32_t kDropped = 0, kTaken = 1, kWaiting = 2;  // of a tuple, in `chosen`
constexpr std::uint32_t kNobody = 0xFFFFFFFFU;                   // of a detection, in `owner`

// visit(index of the detection in `used` and `owner`) for each of a tuple's.
template <class Visit>
__device__ void each_detection(const CudaTuples& tuples, const CudaGhosts& ghosts, std::uint32_t i,
                               const Visit& visit) {
  for (std::uint32_t v = 0; v < tuples.views; ++v) {
    const std::uint32_t detection = tuples.detection[std::size_t{v} * tuples.capacity + i];
    if (detection != kNoDetection) visit(std::size_t{v} * ghosts.max_detections + detection);
  }
}

__device__ bool goes_before(const CudaTuples& tuples, const double* s, CudaRank rank, std::uint32_t a,
                            std::uint32_t b) {
  std::uint32_t views_a = 0, views_b = 0;
  int first = 0;  // below 0: a's detections are the lower ones
  for (std::uint32_t v = 0; v < tuples.views; ++v) {
    const std::uint32_t of_a = tuples.detection[std::size_t{v} * tuples.capacity + a];
    const std::uint32_t of_b = tuples.detection[std::size_t{v} * tuples.capacity + b];
    views_a += of_a != kNoDetection, views_b += of_b != kNoDetection;
    if (first == 0 && of_a != of_b) first = of_a < of_b ? -1 : 1;
  }
  if (rank == CudaRank::by_views_then_s && views_a != views_b) return views_a > views_b;
  if (s[a] != s[b]) return s[a] < s[b];
  return first != 0 ? first < 0 : a < b;
}

// The best of all that call it owns the detection; an owner that no longer waits is none.
__device__ void claim(const CudaTuples& tuples, const CudaGhosts& ghosts, CudaRank rank, std::uint32_t i,
                      std::uint32_t* owner) {
  std::uint32_t seen = atomicCAS(owner, kNobody, i);
  while (seen != kNobody && seen != i &&
         (ghosts.chosen[seen] != kWaiting || goes_before(tuples, ghosts.s, rank, i, seen))) {
    const std::uint32_t before = atomicCAS(owner, seen, i);
    if (before == seen) return;
    seen = before;
  }
}

__global__ void choose(CudaTuples tuples, CudaGhosts ghosts, CudaRank rank) {
  const std::uint32_t count = min(*tuples.count, tuples.capacity);
  for (std::uint32_t i = threadIdx.x; i < count; i += blockDim.x) {
    bool free = ghosts.s[i] == ghosts.s[i];
    each_detection(tuples, ghosts, i, [&](std::size_t d) {
      free = free && ghosts.used[d] == 0;
      atomicExch(&ghosts.owner[d], kNobody);
    });
    if (ghosts.chosen[i] != kTaken) ghosts.chosen[i] = free ? kWaiting : kDropped;
  }
  int waiting = 1;
  while (__syncthreads_or(waiting) != 0) {
    for (std::uint32_t i = threadIdx.x; i < count; i += blockDim.x)
      if (ghosts.chosen[i] == kWaiting)
        each_detection(tuples, ghosts, i, [&](std::size_t d) { claim(tuples, ghosts, rank, i, &ghosts.owner[d]); });
    __syncthreads();
    for (std::uint32_t i = threadIdx.x; i < count; i += blockDim.x) {
      bool best = ghosts.chosen[i] == kWaiting;
      each_detection(tuples, ghosts, i, [&](std::size_t d) { best = best && ghosts.owner[d] == i; });
      if (!best) continue;
      ghosts.chosen[i] = kTaken;
      each_detection(tuples, ghosts, i, [&](std::size_t d) { ghosts.used[d] = 1; });
    }
    __syncthreads();
    waiting = 0;
    for (std::uint32_t i = threadIdx.x; i < count; i += blockDim.x) {
      if (ghosts.chosen[i] != kWaiting) continue;
      bool free = true;
      each_detection(tuples, ghosts, i, [&](std::size_t d) { free = free && ghosts.used[d] == 0; });
      if (free)
        waiting = 1;
      else
        ghosts.chosen[i] = kDropped;
    }
  }
}

}  // namespace

bool choose_by_rank_cuda(const CudaTuples& tuples, const CudaGhosts& ghosts, CudaRank rank, void* stream,
                         unsigned threads_per_block) noexcept {
  return launch(choose, threads_per_block, threads_per_block, stream, tuples, ghosts, rank);
}

}  // namespace rptv
