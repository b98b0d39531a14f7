// SPDX-License-Identifier: MIT
// What a particle's image looks like, for particles all over a lenslet's cell and all depths: rendered once, then
// shifted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/light_field/particle_image.hpp"
#include "reconstruct/light_field/shake_step.hpp"

namespace rptv {

/// Depths and places within a cell that are tried.
struct FootprintGrid {
  double lowest_z_mm = 0, highest_z_mm = 0;
  double depth_step_mm = 1;
  std::int32_t places = 6;  ///< along each axis of a cell
};

/// The image of a particle at (place in the cell of lenslet, depth) moves with the lenslet's spot, whatever the pupil's
/// distance: on the array plane it depends on the place in the cell only. Spots lie between pixels, which costs up to
/// half a pixel. Immutable but for set_light(); any thread.
class Footprints {
 public:
  struct Pixel {
    std::int32_t offset;  ///< from the pixel of the lenslet's spot, row·stride + column
    std::int16_t column, row;
    float share;           ///< of the particle's light
    float grey, weighted;  ///< for the light of set_light(); and over the variance of such a grey value
  };
  /// One image: a sample of its pixels first, then the others.
  struct Footprint {
    std::uint32_t first = 0, sampled = 0, count = 0;
    float sampled_norm = 0, norm = 0;  ///< Σ grey·weighted
    float grey = 0;                    ///< Σ grey
    std::int32_t left = 0, right = 0, top = 0, bottom = 0;
  };

  /// Throws Error(configuration) without a pupil radius, or
  /// when the table would be out of proportion.
  Footprints(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ImageModelOptions& model,
             const FootprintGrid& grid);

  void set_light(double light, double dark_variance, double variance_per_grey) noexcept;

  std::span<const Footprint> all() const noexcept { return footprints_; }
  std::span<const Pixel> pixels(const Footprint& f) const noexcept { return {pixels_.data() + f.first, f.count}; }
  /// Pixel of a lenslet's spot: column, row.
  std::array<std::int32_t, 2> spot_px(std::uint32_t lenslet) const noexcept;
  /// The particle whose image near `lenslet` is footprint number `footprint`.
  ImagePoint at(std::size_t footprint, std::uint32_t lenslet) const noexcept;
  /// Pixels of the largest and of the average image, faint ones included.
  std::size_t most_pixels() const noexcept { return most_pixels_; }
  std::size_t mean_pixels() const noexcept { return mean_pixels_; }

 private:
  void add(const ParticleImage& image, std::array<std::int32_t, 2> spot, Footprint& footprint);

  const LensletLattice& lattice_;
  const FootprintGrid grid_;
  const ChiefRay chief_;
  const std::int32_t stride_;
  const double pixel_mm_;
  const std::array<double, 2> axis_px_;
  std::vector<Footprint> footprints_;  // by depth, row and column in the cell
  std::vector<Pixel> pixels_;
  std::size_t most_pixels_ = 0, mean_pixels_ = 0;
};

}  // namespace rptv
