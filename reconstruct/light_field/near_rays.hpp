// SPDX-License-Identifier: MIT
// Which rays pass near a point: the search behind fits, claims and assignments.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/instruction_set.hpp"
#include "reconstruct/light_field/ray_gate_kernel.hpp"
#include "reconstruct/light_field/ray_sums.hpp"
#include "reconstruct/light_field/ray_window.hpp"

namespace rptv {

struct NearRayLoops;

/// Numbers of rays, and RayGate::distance() of their offsets from a point.
struct NearList {
  std::uint32_t* number;
  float* distance_mm;
  static constexpr std::size_t kSlack = 16;  ///< elements that may be written behind the last one
};

/// Finds the rays whose distance from a point is at most a reach, in single precision: the same for every instruction
/// set. One workspace per thread; nothing allocates after construction.
class NearRays {
 public:
  /// `window` must outlive this; the processor must have `set`.
  NearRays(const RayWindow& window, std::size_t max_rays, InstructionSet set = best_instruction_set());

  /// Their numbers, ascending; valid until the next call, as distances_mm().
  std::span<const std::uint32_t> find(const Rays& rays, const RayGate& gate, const ImagePoint& at,
                                      double reach_mm) noexcept;
  std::span<const float> distances_mm() const noexcept { return {distance_mm_.data(), found_}; }

  /// Those with taken[number of the ray] == 0, as columns, into `near` (of capacity max_rays).
  void gather(const Rays& rays, std::span<const std::uint8_t> taken, const RayGate& gate, const ImagePoint& at,
              double reach_mm, RayColumns& near) const noexcept;
  /// Drops the columns that are farther than `reach_mm` from `at`.
  void keep(const RayGate& gate, const ImagePoint& at, double reach_mm, RayColumns& near) const noexcept;

 private:
  const RayWindow& window_;
  const NearRayLoops& loops_;
  std::vector<std::uint32_t> number_;
  std::vector<float> distance_mm_;
  std::size_t found_ = 0;
};

}  // namespace rptv
