// SPDX-License-Identifier: MIT
// Turns in parallel, with the order of ExplainAway checked. A candidate's turn is the least support that it has had
// while it waited, since the heap gives it out then; only turns that are earlier may take rays from it. Whoever takes
// or uses a ray leaves the turn there; should a candidate come upon rays that a later turn has used or taken, which
// happens when a fit leads away from the rays that it was looking at, the device says that it is unsure.
#include "reconstruct/light_field/explain_away_cuda.hpp"

#include "reconstruct/light_field/near_rays_cuda.hpp"

namespace rptv {

namespace {

enum State : std::uint32_t { kGone, kQueued, kFitted, kAccepted };

constexpr CudaTurn kPast = ~CudaTurn{0};
constexpr std::uint32_t kNone = 0xFFFFFFFFU;

__device__ CudaTurn turn_of(std::uint32_t support, std::uint32_t candidate) {
  return (static_cast<CudaTurn>(support) << 32U) | (kNone - candidate);
}
__device__ std::uint32_t candidates_of(const CudaExplain& e) { return min(*e.candidates, e.candidate_capacity); }
// Of this warp; those that have no memory of their own get none.
__device__ std::uint32_t first_item(const CudaExplain& e) {
  const std::uint32_t warp = cuda_item() / kWarp;
  return warp < e.warps ? warp : kNone;
}
__device__ double zone_reach_mm(const CudaExplain& e, std::uint32_t i) {
  return gather_reach_mm(e.limits.fit, e.window.slope_half_range, e.at[i].z);
}

__global__ void free_rays(CudaExplain e) {
  const std::uint32_t rays = *e.rays.size;
  for (std::uint32_t i = cuda_item(); i < rays; i += cuda_stride()) e.taken_at[i] = 0;
}

__global__ void mark_taken(CudaExplain e) {
  const std::uint32_t rays = *e.rays.size;
  for (std::uint32_t i = cuda_item(); i < rays; i += cuda_stride()) {
    const bool taken = e.taken_at[i] != 0;
    e.taken[i] = taken ? 1 : 0;
    e.taken_at[i] = taken ? kPast : 0;
    e.used_at[i] = kPast;
  }
}

__global__ void queue_up(CudaExplain e) {
  const std::uint32_t count = candidates_of(e);
  for (std::uint32_t i = cuda_item(); i < count; i += cuda_stride()) {
    const Candidate& candidate = e.candidate[i];
    e.at[i] = {candidate.x_mm, candidate.y_mm, candidate.z_mm};
    e.support[i] = candidate.rays;
    e.turn[i] = turn_of(candidate.rays, i);
    e.state[i] = kQueued;
  }
}

// The first turn at each pixel, among those that look at its rays.
__global__ void call_turns(CudaExplain e) {
  const std::uint32_t count = candidates_of(e);
  for (std::uint32_t i = first_item(e); i < count; i += e.warps) {
    if (e.state[i] != kQueued && e.state[i] != kFitted) continue;
    const double reach_mm = zone_reach_mm(e, i);
    const RaySearch search = search_of(e.limits.fit.gate, e.at[i], reach_mm);
    const CudaTurn turn = e.turn[i];
    visit_near(e.window, e.rays, e.at[i], reach_mm, [&](std::uint32_t ray, bool real) {
      if (real && e.taken_at[ray] == 0 && distance_mm(e.rays.ray[ray], search) <= search.reach)
        atomicMax(&e.next[e.rays.pixel[ray]], turn);
      return true;
    });
  }
}

// Gathers the free rays that a candidate looks at; false where one of them is another's first.
__device__ bool gather_own(const CudaExplain& e, std::uint32_t i, WarpNear& near) {
  const double reach_mm = zone_reach_mm(e, i);
  const RaySearch search = search_of(e.limits.fit.gate, e.at[i], reach_mm);
  const CudaTurn turn = e.turn[i];
  bool all_own = true, early = false;
  visit_near(e.window, e.rays, e.at[i], reach_mm, [&](std::uint32_t ray, bool real) {
    const bool inside = real && distance_mm(e.rays.ray[ray], search) <= search.reach;
    const CudaTurn taken_at = inside ? e.taken_at[ray] : 0;
    early = early || (taken_at != 0 && taken_at < turn);
    const bool free = inside && taken_at == 0;
    all_own = __all_sync(kAllLanes, !free || e.next[e.rays.pixel[ray]] == turn);
    near.append(ray, free);
    return all_own;
  });
  __syncwarp();
  if (!all_own) return false;
  if (early) atomicOr(&e.explained->unsure, kOutOfTurn);
  if (near.size > near.capacity && cuda_lane() == 0) atomicOr(&e.explained->unsure, kTooManyNear);
  return near.size <= near.capacity;
}

// From now on only later turns may take these.
__device__ void use(const CudaExplain& e, const WarpNear& near, CudaTurn turn) {
  for (std::uint32_t k = cuda_lane(); k < near.size; k += kWarp) atomicMin(&e.used_at[near.number[k]], turn);
}

/// What becomes of a candidate.
struct Outcome {
  State state;
  ImagePoint at;
  std::uint32_t support;
};

__device__ Outcome outcome_of(const CudaExplain& e, std::uint32_t i, WarpNear& near) {
  const FitOptions& fit = e.limits.fit;
  const Outcome gone{kGone, e.at[i], 0};
  if (e.state[i] == kFitted && near.count(e.at[i], fit.gate.half_width_at(e.at[i].z)) >= e.support[i])
    return {kAccepted, e.at[i], e.support[i]};
  if (near.size < fit.min_support) return gone;
  ImagePoint at = e.at[i];
  if (!converge(near, fit, at)) return gone;
  const FittedPoint found = last_step(near, fit, at);
  if (!e.limits.accept(found.support, found.at.z)) return gone;
  const auto support = static_cast<std::uint32_t>(found.support);
  // As strong as before, it is the next that the heap gives out, and nothing has been taken since.
  return {turn_of(support, i) >= e.turn[i] ? kAccepted : kFitted, found.at, support};
}

__global__ void take_turns(CudaExplain e) {
  RPTV_SHARED(WarpSums, sums);
  const std::uint32_t count = candidates_of(e);
  for (std::uint32_t i = first_item(e); i < count; i += e.warps) {
    if (e.state[i] != kQueued && e.state[i] != kFitted) continue;
    WarpNear near{e.rays, e.limits.fit.gate, e.near + std::size_t{cuda_item() / kWarp} * e.near_capacity,
                  e.near_capacity, sums};
    const bool now = gather_own(e, i, near);
    Outcome outcome{kFitted, e.at[i], 0};
    if (now) {
      use(e, near, e.turn[i]);
      outcome = outcome_of(e, i, near);
    }
    __syncwarp();  // all lanes have read what follows
    if (cuda_lane() != 0) continue;
    if (now) {
      e.state[i] = outcome.state, e.at[i] = outcome.at, e.support[i] = outcome.support;
      if (outcome.state == kAccepted)
        e.accepted[atomicAdd(&e.explained->accepted, 1U)] = i;
      else if (outcome.state == kFitted)
        e.turn[i] = turn_of(outcome.support, i);
    }
    if (outcome.state == kFitted) atomicAdd(&e.explained->waiting, 1U);
  }
}

// ExplainAway::claim().
__global__ void claim(CudaExplain e) {
  const std::uint32_t count = candidates_of(e);
  for (std::uint32_t i = first_item(e); i < count; i += e.warps) {
    if (e.state[i] != kAccepted) continue;
    const double reach_mm = kClaimWider * e.limits.fit.gate.half_width_at(e.at[i].z);
    const RaySearch search = search_of(e.limits.fit.gate, e.at[i], reach_mm);
    const CudaTurn turn = e.turn[i];
    visit_near(e.window, e.rays, e.at[i], reach_mm, [&](std::uint32_t ray, bool real) {
      if (!real || !(distance_mm(e.rays.ray[ray], search) <= search.reach)) return true;
      std::uint32_t same = ray;
      do {
        if (atomicMax(&e.taken_at[same], turn) < turn && e.used_at[same] < turn)
          atomicOr(&e.explained->unsure, kOutOfTurn);
        same = e.rays.same_pixel[same];
      } while (same != ray);
      return true;
    });
    __syncwarp();  // all lanes have read the state
    if (cuda_lane() == 0) e.state[i] = kGone;
  }
}

__global__ void append_particles(CudaExplain e) {
  const std::uint32_t accepted = e.explained->accepted;
  for (std::uint32_t k = cuda_item(); k < accepted; k += cuda_stride()) {
    const std::uint32_t i = e.accepted[k];
    std::uint32_t at = e.explained->particles;
    for (std::uint32_t other = 0; other < accepted; ++other) at += e.turn[e.accepted[other]] > e.turn[i];
    if (at < e.particle_capacity)
      e.particle[at] = {e.at[i], static_cast<double>(e.support[i]), 0, {}};
    else
      atomicOr(&e.explained->unsure, kTooManyParticles);
  }
}

__global__ void count_round(CudaExplain e) {
  CudaExplained& all = *e.explained;
  if (cuda_item() != 0) return;
  all.particles = min(all.particles + all.accepted, e.particle_capacity);
  if (all.waiting > 0) all.unsure |= kTooFewTurns;
  if (all.over != 0) return;
  const std::uint32_t kept = candidates_of(e);
  ++all.rounds, all.candidates += kept, all.refused_candidates += *e.candidates - kept;
  all.over = all.accepted == 0 ? 1 : 0;
}

bool clear(void* values, std::size_t bytes, void* stream) noexcept {
  return cudaMemsetAsync(values, 0, bytes, static_cast<cudaStream_t>(stream)) == cudaSuccess;
}

}  // namespace

bool begin_explaining_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block) noexcept {
  return clear(explain.explained, sizeof(CudaExplained), stream) &&
         launch(free_rays, explain.rays.capacity, threads_per_block, stream, explain);
}

bool begin_round_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block) noexcept {
  return clear(&explain.explained->accepted, sizeof(std::uint32_t), stream) &&
         launch(mark_taken, explain.rays.capacity, threads_per_block, stream, explain);
}

bool queue_up_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block) noexcept {
  return launch(queue_up, explain.candidate_capacity, threads_per_block, stream, explain);
}

bool take_turns_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block) noexcept {
  const std::size_t threads = std::size_t{explain.warps} * kWarp;
  return clear(explain.next, explain.rays.capacity * sizeof(CudaTurn), stream) &&
         clear(&explain.explained->waiting, sizeof(std::uint32_t), stream) &&
         launch(call_turns, threads, threads_per_block, stream, explain) &&
         launch(take_turns, threads, threads_per_block, stream, explain) &&
         launch(claim, threads, threads_per_block, stream, explain);
}

bool end_round_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block) noexcept {
  return launch(append_particles, explain.candidate_capacity, threads_per_block, stream, explain) &&
         launch(count_round, 1, threads_per_block, stream, explain);
}

}  // namespace rptv
