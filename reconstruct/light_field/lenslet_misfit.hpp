// SPDX-License-Identifier: MIT
// How much wider a fitted particle's errors are than pixel noise makes them, by how its lenslets disagree.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "reconstruct/light_field/shake_sums.hpp"

namespace rptv {

/// Light of a missed or misplaced neighbour fills whole sub-images: its residuals are not independent, and pull as one.
/// With g the pull and H the normal matrix of the pixels of one lenslet, noise alone makes Q = Σ gᵀH⁻¹g over lenslets a
/// χ² of (ranks of all H) - 4 degrees of freedom, since all pulls together are nothing. What Q has beyond noise is the
/// factor by which the variance of the whole fit is larger (clustered errors, Liang & Zeger 1986, as one number: few
/// lenslets do not give a matrix). Nothing allocates after construction; one per thread.
class LensletMisfit {
 public:
  /// `lattice` must outlive this.
  LensletMisfit(const LightFieldCalibration& calibration, const LensletLattice& lattice);

  /// The factor, at least 1; 1 where lenslets disagree no more than by noise, or there is but one. At the best place
  /// and light.
  double operator()(const ParticleImage& image, const Seen& seen, double light) noexcept;

 private:
  static constexpr std::size_t kMostLenslets = 128;  // those beyond are taken for the last
  struct Pull {
    std::int32_t column = 0, row = 0;  // of the lenslet whose spot is nearest
    std::array<double, 10> normal{};   // as ShakeSums
    std::array<double, 4> pull{};
  };
  Pull& pull_of(std::uint32_t pixel) noexcept;

  const LensletLattice& lattice_;
  const std::uint32_t width_px_;
  const double pixel_mm_;
  const std::array<double, 2> axis_px_;
  std::vector<Pull> pulls_;
  std::size_t count_ = 0, last_ = 0;
};

}  // namespace rptv
