// SPDX-License-Identifier: MIT
// Explaining away on the device: candidates that share no rays take their turns at the same time, with the CPU's
// result.
#pragma once

#include <cstddef>
#include <cstdint>

#include "reconstruct/light_field/coarse_maxima_kernel.hpp"
#include "reconstruct/light_field/explain_away_kernel.hpp"
#include "reconstruct/light_field/ray_window_kernel.hpp"
#include "reconstruct/light_field/rays_cuda.hpp"

namespace rptv {

/// When a candidate's turn comes: support · 2³² + 2³² - 1 - its number. Higher ones come first, as in ExplainAway.
using CudaTurn = unsigned long long;

/// What a device has to say of a round, and of all.
struct CudaExplained {
  std::uint32_t waiting;                                 ///< candidates whose turn has not come
  std::uint32_t accepted;                                ///< in this round
  std::uint32_t particles;                               ///< in all
  std::uint32_t rounds, candidates, refused_candidates;  ///< in all, up to the first round that accepts none
  std::uint32_t over;                                    ///< 1: that round has been
  std::uint32_t unsure;                                  ///< 0, or why the result may not be the CPU's: CudaUnsure
};
enum CudaUnsure : std::uint32_t {
  kTooManyNear = 1,       ///< more rays near a candidate than there is room for
  kOutOfTurn = 2,         ///< a candidate has moved to rays that one with a later turn had used
  kTooManyParticles = 4,  ///< the CPU leaves out the last ones, whose rays others may then take
  kTooFewTurns = 8,       ///< candidates waited at the end of a round
};

/// A particle without what the image shows.
struct CudaParticle {
  ImagePoint at;
  double support, residual_mm;
  FitCovariance covariance;
};

/// Rays, candidates, and work memory; all pointers are the device's.
struct CudaExplain {
  CudaRays rays;
  RayWindowKernel window;
  ExplainLimits limits;
  const Candidate* candidate;       ///< candidate_capacity
  const std::uint32_t* candidates;  ///< one: how many there are, or would be
  std::uint32_t candidate_capacity, particle_capacity;

  ImagePoint* at;                             ///< of a candidate
  std::uint32_t *support, *state, *accepted;  ///< of a candidate
  CudaTurn* turn;                             ///< of a candidate
  CudaTurn *taken_at, *used_at;  ///< of a ray: the turn that took it, 0: none; the last turn that used it free
  CudaTurn* next;                ///< of a pixel: the first of those turns that look at its rays
  std::uint8_t* taken;           ///< of a ray, for count_rays_cuda()
  std::uint32_t* near;           ///< warps × near_capacity
  std::uint32_t warps, near_capacity;
  CudaParticle *particle, *settled;  ///< particle_capacity each
  std::uint32_t *weak, *run_memory;  ///< particle_capacity; compact_runs(particle_capacity)
  CudaExplained* explained;          ///< one
};

/// All queue work on `stream` (a cudaStream_t) and are false when the runtime refuses. `threads_per_block`: a multiple
/// of 32, kMostFitThreads at most.

/// As ExplainAway::begin(): all rays are free, there is no particle.
bool begin_explaining_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block = 128) noexcept;
/// Before candidates are searched: what is taken becomes known in `taken`, and past.
bool begin_round_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block = 128) noexcept;
/// Then the candidates wait for their turns.
bool queue_up_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block = 128) noexcept;
/// Each candidate that no other one with rays in common goes before: it is fitted, and accepted when ExplainAway would
/// accept it next, or waits for a later turn. `explained` says how many wait.
bool take_turns_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block = 128) noexcept;
/// When none waits (else the result is unsure): those that were accepted become particles, in the order of their turns.
bool end_round_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block = 128) noexcept;
/// ExplainAway::settle(), but for the order of the particles.
bool settle_cuda(const CudaExplain& explain, void* stream, unsigned threads_per_block = 128) noexcept;

}  // namespace rptv
