// SPDX-License-Identifier: MIT
// Turns are queued several at a time, since asking how many wait takes longer than a few that find nobody.
#include "reconstruct/light_field/explainer_cuda.hpp"

#include <algorithm>

#include "reconstruct/cuda_scan.hpp"
#include "reconstruct/cuda_stage_timer.hpp"

namespace rptv {

namespace {

constexpr std::uint32_t kMostWarps = 1024, kMostNear = 4096;
constexpr int kTurnsAtOnce = 8;

std::uint32_t u32(std::size_t value) noexcept { return static_cast<std::uint32_t>(value); }

std::uint32_t warps_for(const LightFieldDevicePlan& plan) {
  return u32(std::clamp<std::size_t>(plan.max_candidates, 1, kMostWarps));
}
std::uint32_t near_for(const LightFieldDevicePlan& plan) {
  return u32(std::min<std::size_t>(plan.max_rays, kMostNear));
}

}  // namespace

ExplainerCuda::ExplainerCuda(const LightFieldDevicePlan& plan, const CudaRays& rays, const CudaCandidates& candidates)
    : at_(plan.max_candidates),
      support_(plan.max_candidates),
      state_(plan.max_candidates),
      accepted_(plan.max_candidates),
      near_(std::size_t{warps_for(plan)} * near_for(plan)),
      weak_(plan.explain.max_particles),
      runs_(compact_runs(plan.explain.max_particles)),
      turn_(plan.max_candidates),
      taken_at_(plan.max_rays),
      used_at_(plan.max_rays),
      next_(plan.max_rays),
      taken_(plan.max_rays),
      particle_(plan.explain.max_particles),
      settled_(plan.explain.max_particles),
      on_device_(1),
      explained_(1),
      particles_(plan.explain.max_particles),
      explain_{rays,
               plan.window.kernel(),
               plan.explain,
               candidates.candidate,
               candidates.size,
               candidates.capacity,
               u32(plan.explain.max_particles),
               at_.data(),
               support_.data(),
               state_.data(),
               accepted_.data(),
               turn_.data(),
               taken_at_.data(),
               used_at_.data(),
               next_.data(),
               taken_.data(),
               near_.data(),
               warps_for(plan),
               near_for(plan),
               particle_.data(),
               settled_.data(),
               weak_.data(),
               runs_.data(),
               on_device_.data()} {
  explained_[0] = {};
}

bool ExplainerCuda::explain(CudaStream& stream) noexcept {
  if (!stream.stage(CudaStage::fits) || !queue_up_cuda(explain_, stream.handle())) return false;
  do {
    stream.stage(CudaStage::fits);
    for (int turn = 0; turn < kTurnsAtOnce; ++turn)
      if (!take_turns_cuda(explain_, stream.handle())) return false;
    if (!stream.stage(CudaStage::download) ||
        !stream.download(&explained_[0], on_device_.data(), sizeof(CudaExplained)) || !stream.stage(CudaStage::none) ||
        !stream.synchronize())
      return false;
  } while (explained_[0].waiting > 0 && sure());
  return stream.stage(CudaStage::fits) && end_round_cuda(explain_, stream.handle());
}

bool ExplainerCuda::queue_turns(CudaStream& stream, int turns) noexcept {
  bool done = stream.stage(CudaStage::fits) && queue_up_cuda(explain_, stream.handle());
  for (int turn = 0; turn < turns; ++turn) done = done && take_turns_cuda(explain_, stream.handle());
  return done && end_round_cuda(explain_, stream.handle());
}

bool ExplainerCuda::queue_settle(CudaStream& stream) noexcept {
  return stream.stage(CudaStage::fits) && settle_cuda(explain_, stream.handle()) && stream.stage(CudaStage::download) &&
         stream.download(&explained_[0], on_device_.data(), sizeof(CudaExplained)) &&
         stream.download(particles_.data(), particle_.data(), particle_.size() * sizeof(CudaParticle)) &&
         stream.stage(CudaStage::none);
}

void ExplainerCuda::read(DeviceParticles& particles) const noexcept {
  const CudaExplained& all = explained_[0];
  particles.sure = sure(), particles.rounds = all.rounds;
  particles.candidates = all.candidates, particles.refused_candidates = all.refused_candidates;
  particles.found.clear();
  for (std::size_t k = 0; sure() && k < all.particles; ++k) {
    FittedParticle& particle = particles.found.emplace_back();
    particle.at = particles_[k].at, particle.support = particles_[k].support;
    particle.residual_mm = particles_[k].residual_mm, particle.covariance = particles_[k].covariance;
  }
  std::sort(particles.found.begin(), particles.found.end(), by_support);
}

}  // namespace rptv
