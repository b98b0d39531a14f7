// SPDX-License-Identifier: MIT
// What a camera makes of light: Poisson photoelectrons, read noise, gain, black level, clipping.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/image.hpp"
#include "simulation/scenario.hpp"

namespace rptv {

/// Grey values of one camera. `pixels` hold shape().bytes(): uint8 up to 8 bits, else uint16. Noise depends on the
/// scenario's seed and the stream only. Immutable; any thread.
class Exposure {
 public:
  explicit Exposure(const ScenarioSettings& scenario);

  ImageShape shape() const noexcept { return shape_; }
  /// Photoelectrons between black level and full scale.
  double full_well_e() const noexcept { return (full_scale_ - camera_.black_level_dn) * camera_.gain_e_per_dn; }
  /// `expected` photoelectrons per pixel, without stray light; row-major.
  void expose(std::span<const float> expected, std::uint64_t stream, std::span<std::byte> pixels) const;
  /// No light, no stray light: black level and read noise.
  void expose_dark(std::span<std::byte> pixels) const;
  /// Black level and stray light, without noise, rounded.
  void mean_without_light(std::span<std::byte> pixels) const;

 private:
  template <class Pixel>
  void expose_as(std::span<const float> expected, double stray_e, std::uint64_t stream, Pixel* pixels) const;
  CameraSettings camera_;
  std::uint64_t seed_;
  ImageShape shape_;
  double full_scale_;
};

}  // namespace rptv
