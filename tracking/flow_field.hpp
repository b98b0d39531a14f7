// SPDX-License-Identifier: MIT
// The flow as the tracks have shown it so far: a running mean velocity in cubes of space.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace rptv {

/// Position mm and velocity mm/s at it.
struct VelocitySample {
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double vx_mm_s = 0, vy_mm_s = 0, vz_mm_s = 0;
};

/// Mean of the last samples of each cube, older ones fading (weight 1/kMemory for a new one in the long run). Cubes lie
/// in a hash table of fixed size: what finds no place in it is left out. One thread; only construction allocates.
class FlowField {
 public:
  static constexpr std::uint32_t kMemory = 64;  ///< samples
  static constexpr std::uint32_t kEnough = 3;   ///< samples before a cube is believed

  /// `bin_mm` > 0; `bins`: cubes that have room, rounded up to a power of two.
  FlowField(double bin_mm, std::size_t bins);

  void add(const VelocitySample& sample) noexcept;
  /// Fills the velocity of `at` from the cube that its position is in; false where too little is known.
  bool look_up(VelocitySample& at) const noexcept;

  struct Bin {
    std::uint64_t key = 0;  ///< 0: empty
    double vx_mm_s = 0, vy_mm_s = 0, vz_mm_s = 0;
    std::uint32_t samples = 0;
  };
  const std::vector<Bin>& bins() const noexcept { return bins_; }
  void restore(const std::vector<Bin>& bins) { bins_ = bins; }

 private:
  static constexpr std::size_t kProbes = 8;
  std::uint64_t key_of(const VelocitySample& sample) const noexcept;
  std::size_t place_of(std::uint64_t key) const noexcept;

  double per_bin_;
  std::vector<Bin> bins_;
};

}  // namespace rptv
