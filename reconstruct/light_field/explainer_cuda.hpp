// SPDX-License-Identifier: MIT
// Explaining away on the device, from the host: its memory, and turns until none waits.
#pragma once

#include <vector>

#include "reconstruct/cuda_memory.hpp"
#include "reconstruct/light_field/coarse_maxima_cuda.hpp"
#include "reconstruct/light_field/explain_away_cuda.hpp"
#include "reconstruct/light_field/light_field_device.hpp"

namespace rptv {

/// Nothing is allocated after construction. Rays and candidates are another's; calls queue work on the same stream as
/// theirs and are false when the device refuses.
class ExplainerCuda {
 public:
  /// `rays` and `candidates` stay where they are. Throws Error(unavailable) without room on the device.
  ExplainerCuda(const LightFieldDevicePlan& plan, const CudaRays& rays, const CudaCandidates& candidates);

  /// ExplainAway::begin().
  bool begin(CudaStream& stream) noexcept { return begin_explaining_cuda(explain_, stream.handle()); }
  /// Before the candidates of a round are searched among the rays that are not `taken()`.
  bool begin_round(CudaStream& stream) noexcept { return begin_round_cuda(explain_, stream.handle()); }
  const std::uint8_t* taken() const noexcept { return explain_.taken; }
  /// ExplainAway::explain() with the candidates: waits until their turns are over. accepted() tells how many were.
  bool explain(CudaStream& stream) noexcept;
  std::uint32_t accepted() const noexcept { return explained_[0].accepted; }
  /// The same in so many turns, and without waiting.
  bool queue_turns(CudaStream& stream, int turns) noexcept;
  /// ExplainAway::settle(), without waiting.
  bool queue_settle(CudaStream& stream) noexcept;
  /// What is known when the stream has got there.
  void read(DeviceParticles& particles) const noexcept;
  bool sure() const noexcept { return explained_[0].unsure == 0; }
  bool needs_more_turns() const noexcept { return explained_[0].unsure == kTooFewTurns; }

 private:
  DeviceArray<ImagePoint> at_;
  DeviceArray<std::uint32_t> support_, state_, accepted_, near_, weak_, runs_;
  DeviceArray<CudaTurn> turn_, taken_at_, used_at_, next_;
  DeviceArray<std::uint8_t> taken_;
  DeviceArray<CudaParticle> particle_, settled_;
  DeviceArray<CudaExplained> on_device_;
  PinnedArray<CudaExplained> explained_;
  PinnedArray<CudaParticle> particles_;
  const CudaExplain explain_;
};

}  // namespace rptv
