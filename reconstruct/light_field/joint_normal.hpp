// SPDX-License-Identifier: MIT
// The normal equations of all particles of a frame together, sparse: who shares no pixel has no block.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/joint_images.hpp"

namespace rptv {

/// x, y, z and light of a particle.
using JointStep = std::array<float, 4>;

/// How two particles that share pixels are coupled: the first's four rows, the four columns of `other`.
struct JointBlock {
  std::uint32_t other;
  std::array<float, 16> entries;
};

/// Gauss-Newton: assemble() once, solve() with any damping. Nothing allocates after construction; one thread calls,
/// `threads` work, and the result does not depend on their number.
class JointNormal {
 public:
  JointNormal(std::size_t sensor_pixels, std::size_t max_particles, std::size_t max_entries, std::size_t threads);

  /// `weight`: of each pixel of the sensor; `rest`: what it has beyond the model. A particle whose light is at
  /// `most_light`, and would be more, stays there.
  void assemble(const JointImages& images, std::span<const JointParticle> particles, std::span<const float> weight,
                std::span<const float> rest, double most_light) noexcept;
  /// (normal + damping·diagonal)⁻¹·pull by conjugate gradients, preconditioned particle by particle; valid until the
  /// next call. Returns the steps.
  std::span<const JointStep> solve(float damping) noexcept;

  /// The matrix of the last assemble(), scaled to a unit diagonal: a particle's own block, those with particles of
  /// lower numbers, and the scale, which is that of its parameters.
  std::size_t particles() const noexcept { return count_; }
  std::size_t max_blocks() const noexcept { return blocks_.size(); }
  std::span<const float, 16> diagonal(std::size_t k) const noexcept { return diagonal_[k]; }
  std::span<const JointBlock> blocks_of(std::size_t k) const noexcept {
    if (blocks_of_[k].count == 0) return {};
    return {blocks_.data() + blocks_of_[k].first, blocks_of_[k].count};
  }
  const JointStep& scale_of(std::size_t k) const noexcept { return scale_[k]; }
  /// Some couplings had no room: those two move as if the other stood still.
  bool is_cut() const noexcept { return cut_.load(std::memory_order_relaxed); }

 private:
  struct Workspace {
    std::vector<std::int32_t> place_of;  // of a neighbour's block, -1: none yet
    std::vector<JointBlock> blocks;
  };
  struct Blocks {
    std::uint32_t first, count;
  };
  void list_touches(const JointImages& images) noexcept;
  void assemble_one(std::size_t k, const JointImages& images, std::span<const JointParticle> particles,
                    std::span<const float> weight, std::span<const float> rest, Workspace& work) noexcept;
  void scale(std::size_t k) noexcept;
  void invert_diagonal(float damping) noexcept;
  void multiply(std::span<const JointStep> x, float damping, std::span<JointStep> y) const noexcept;
  void precondition(std::span<const JointStep> x, std::span<JointStep> y) const noexcept;

  const std::size_t threads_;
  std::size_t count_ = 0;
  std::vector<std::int32_t> newest_, older_;  // entries of a pixel, as lists; -1 ends them
  std::vector<std::uint32_t> owner_;          // of an entry
  std::vector<Workspace> workspaces_;
  std::vector<JointBlock> blocks_;
  std::atomic<std::size_t> blocks_end_{0};
  std::atomic<bool> cut_{false};
  std::vector<Blocks> blocks_of_;
  std::vector<std::array<float, 16>> diagonal_, inverse_;
  std::vector<JointStep> pull_, scale_, x_, r_, z_, p_, q_;
};

}  // namespace rptv
