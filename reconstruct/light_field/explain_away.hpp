// SPDX-License-Identifier: MIT
// A pixel saw one particle: candidates claim their rays in order of support, and ghosts lose theirs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/explain_away_kernel.hpp"
#include "reconstruct/light_field/particle_fit.hpp"
#include "reconstruct/light_field/voxel_cloud.hpp"

namespace rptv {

struct ExplainOptions : ExplainLimits {
  bool claim = true;  ///< false: candidates share rays; those that come to the same point are one
  std::size_t max_particles = 4096;
  std::size_t max_candidates = 4096;
  std::size_t max_rays = 1 << 18;
  std::size_t threads = 1;
};

/// begin() once a frame, explain() once a round, settle() once at the end. Nothing allocates after construction; one
/// thread calls, `threads` settle. The result does not depend on the number of threads.
class ExplainAway {
 public:
  ExplainAway(const RayWindow& window, const ExplainOptions& options);

  void begin(const Rays& rays) noexcept;
  /// Accepts the candidate whose fit explains most free rays, takes its pixels, and so on while any has `min_support`.
  /// Fits are put off until a candidate's turn comes by the rays that pass near it. Returns how many it accepted.
  std::size_t explain(const Rays& rays, std::span<const Candidate> candidates) noexcept;
  /// Gives each pixel to the particle whose ray it fits best and fits again; those left with too little support go.
  void settle(const Rays& rays) noexcept;

  std::span<const FittedParticle> particles() const noexcept { return particles_; }
  std::span<const std::uint8_t> taken() const noexcept { return taken_; }
  std::uint64_t refused() const noexcept { return refused_; }  ///< particles beyond the capacity, since begin()

 private:
  struct Tentative {
    FittedParticle particle;  // before it is fitted: the candidate's position, and its rays as support
    std::uint32_t number = 0;
    bool fitted = false;
    bool operator<(const Tentative& other) const noexcept {
      return particle.support != other.particle.support ? particle.support < other.particle.support
                                                        : number > other.number;
    }
  };
  bool acceptable(const FittedParticle& particle) const noexcept {
    return options_.accept(particle.support, particle.at.z);
  }
  void queue_up(std::span<const Candidate> candidates) noexcept;
  bool improve(const Rays& rays, Tentative& candidate) noexcept;
  bool accept(const Rays& rays, const FittedParticle& particle) noexcept;
  void claim(const Rays& rays, const FittedParticle& particle) noexcept;
  bool known(const FittedParticle& particle) const noexcept;
  void assign(const Rays& rays) noexcept;
  std::span<const std::uint32_t> near_of(std::size_t k) const noexcept {
    return {near_.data() + (k == 0 ? 0 : near_end_[k - 1]), near_.data() + near_end_[k]};
  }
  void fit_owned(const Rays& rays, FitFor purpose) noexcept;
  void drop_weak() noexcept;

  const ExplainOptions options_;
  NearRays search_;
  std::vector<ParticleFit> fits_;     // per thread
  std::vector<std::uint8_t> taken_;   // per ray; all rays of a pixel together
  std::vector<Tentative> tentative_;  // candidates by support: a heap
  std::vector<FittedParticle> particles_;
  std::vector<std::uint32_t> near_;    // rays near the first particles, one after the other
  std::vector<std::size_t> near_end_;  // where those of each end
  std::vector<std::int32_t> owner_;    // particle of each pixel; -1: none
  std::vector<float> owner_distance_;
  std::uint64_t refused_ = 0;
};

}  // namespace rptv
