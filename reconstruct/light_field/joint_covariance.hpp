// SPDX-License-Identifier: MIT
// How sure a particle's place is when its neighbours' places and lights are not known either.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/fit_covariance_kernel.hpp"
#include "reconstruct/light_field/joint_normal.hpp"

namespace rptv {

/// Covariances of one particle's position, image space, mm², its light unknown.
struct JointSpread {
  FitCovariance alone{};   ///< if all others were known: the inverse of its own block of the normal matrix
  FitCovariance shared{};  ///< what is added because they are not: its block of the whole inverse, less `alone`
  bool cut = false;        ///< it is coupled to more than could be taken in: `shared` is widened, and rough
};

/// Marginal covariances: of the inverse of the joint normal matrix, the block of each particle. A particle's group is
/// those that it is coupled to, directly or by way of others, the strongest first (widest paths, as Dijkstra has
/// shortest); all of the group but the particle are eliminated (Schur complement by block Cholesky), the rest is taken
/// for known. Nothing allocates after construction; one thread calls, `threads` work, and the result does not depend on
/// their number.
class JointCovariance {
 public:
  static constexpr std::size_t kMostGroup = 64;

  /// `max_blocks`: as JointNormal::max_blocks().
  JointCovariance(std::size_t max_particles, std::size_t max_blocks, std::size_t threads);

  /// Of the last JointNormal::assemble(); one for each of its particles.
  void find(const JointNormal& normal, std::span<JointSpread> spreads) noexcept;

 private:
  struct Link {
    std::uint32_t other;
    float strength;                 // Frobenius norm of the block, at most 1
    std::array<float, 16> entries;  // of this particle's rows and the other's columns, both whitened
  };
  struct Near {
    std::uint32_t particle;
    float strength;  // along the widest path
  };
  struct Workspace {
    std::vector<float> strength_of, matrix;
    std::vector<std::int32_t> place_of;  // in the group; -1: not in it
    std::vector<Near> group, border;
  };
  void whiten(const JointNormal& normal, std::size_t k) noexcept;
  void link(const JointNormal& normal) noexcept;
  void add_link(std::uint32_t from, std::uint32_t to, const std::array<float, 16>& entries) noexcept;
  float gather_group(std::uint32_t k, Workspace& work) const noexcept;
  void take_in(const Near& near, Workspace& work) const noexcept;
  void eliminate(Workspace& work) const noexcept;
  JointSpread spread_of(const JointNormal& normal, std::uint32_t k, Workspace& work) const noexcept;

  const std::size_t threads_;
  std::vector<std::array<float, 16>> root_;  // inverse of the Cholesky factor of a particle's own block
  std::vector<std::uint32_t> first_link_;    // of a particle; one more closes
  std::vector<std::uint32_t> next_link_;
  std::vector<Link> links_;
  std::vector<Workspace> workspaces_;
};

}  // namespace rptv
