// SPDX-License-Identifier: MIT
// Lit pixels to rays, eq. (5): a table made at start says through which lenslets the light on each pixel may have come.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "core/huge_pages.hpp"
#include "reconstruct/light_field/pixels_to_rays_kernel.hpp"
#include "reconstruct/light_field/rays.hpp"

namespace rptv {

/// Set-up fills a table of lenslet numbers, 4 bytes a pixel and hypothesis. convert() allocates nothing; one thread.
class PixelsToRays {
 public:
  /// `lattice` must outlive this.
  PixelsToRays(const LightFieldCalibration& calibration, const LensletLattice& lattice, std::size_t hypotheses);

  /// Replaces the content of `rays`. Returns how many lit pixels were left out because `rays` was full.
  std::size_t convert(std::span<const std::uint32_t> lit, Rays& rays) const noexcept;

  /// Largest |slope - chief ray's slope| of any pixel along an axis, dimensionless: how far rays can fan out.
  double slope_half_range() const noexcept { return slope_half_range_; }

  const PixelOptics& optics() const noexcept { return optics_; }
  std::size_t hypotheses() const noexcept { return hypotheses_; }
  std::uint32_t width_px() const noexcept { return width_; }
  /// Lenslet numbers [pixel][hypothesis], LensletLattice::kNone fills up.
  std::span<const std::uint32_t> lenslets() const noexcept { return lenslets_; }

 private:
  const LensletLattice& lattice_;
  const std::size_t hypotheses_;
  const std::uint32_t width_;
  const PixelOptics optics_;
  double slope_half_range_ = 0;
  std::vector<std::uint32_t, HugePages<std::uint32_t>> lenslets_;  // [pixel][hypothesis]
};

}  // namespace rptv
