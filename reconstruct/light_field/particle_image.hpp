// SPDX-License-Identifier: MIT
// The forward model of a light-field camera: which pixels a particle lights, and how that changes when it moves.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "reconstruct/light_field/n_ray_fit_kernel.hpp"
#include "reconstruct/light_field/particle_image_kernel.hpp"

namespace rptv {

/// The pixels that one particle lights, each once, and how bright each is per unit of light: `value` sums to 1 when
/// nothing is cut off. All memory is taken by the constructor.
class ParticleImage {
 public:
  explicit ParticleImage(std::size_t max_pixels)
      : pixel(max_pixels), value(max_pixels), dx(max_pixels), dy(max_pixels), dz(max_pixels) {}

  std::vector<std::uint32_t> pixel;  ///< row·width + column on the sensor
  std::vector<float> value;          ///< share of the particle's light
  std::vector<float> dx, dy, dz;     ///< its derivatives with respect to the particle's position, 1/mm
  std::size_t size = 0;
};

struct ImageModelOptions {
  double pupil_radius_mm = 0;      ///< of the exit pupil; telecentric: of the cone, as a slope
  double particle_radius_mm = 0;   ///< of the particle's image at z = 0
  double radius_per_mm = 0;        ///< how it grows towards the main lens, as a share: magnification changes with depth
  double spread_um = 0;            ///< rms blur of a sub-image by the lenslet, beside pixel and diffraction
  double diffraction_zero_um = 0;  ///< first dark line of a lenslet's diffraction, λ·f/pitch; 0: none
};

/// Image space, mm. Immutable after construction but for the workspace of render(): one per thread.
class ImageModel {
 public:
  /// `lattice` must outlive this. Throws Error(configuration) without a pupil radius.
  ImageModel(const LightFieldCalibration& calibration, const LensletLattice& lattice, const ImageModelOptions& options);

  /// False when the particle's image does not fit into `out` or lies off the sensor; `out` is empty then.
  bool render(const ImagePoint& at, ParticleImage& out) noexcept;

  /// How far from its chief ray's pixel a particle's light can fall, px, for |z| up to `depth_mm`.
  double reach_px(double depth_mm) const noexcept;

 private:
  struct Range {
    float low_x, high_x, low_y, high_y;  // slopes
  };
  struct Patch {
    std::int32_t column, row, width, height;
  };
  float* plane(std::size_t k) noexcept;  // 0: light, 1 … 3: its derivatives
  const float* plane(std::size_t k) const noexcept;
  ParticleView view_of(const ImagePoint& at) const noexcept;
  RimView rim_of(std::size_t k, const ImagePoint& at, double particle_sigma) const noexcept;
  bool range_of(const ParticleView& view, float c_x, float c_y, Range& range) const noexcept;
  std::span<const Patch> patches() const noexcept { return {patches_.data(), patch_count_}; }
  Patch patch_of(float c_x, float c_y, const Range& range) const noexcept;
  bool add_patch(const ParticleView& view, float c_x, float c_y, const Range& range, ParticleImage& out) noexcept;
  void light_up(const ParticleView& view, float c_x, float c_y, const Patch& patch) noexcept;
  void blur(float* plane, const Patch& patch) noexcept;
  bool copy_seen(const Patch& patch, float least, ParticleImage& out) const noexcept;
  bool merge(ParticleImage& image) noexcept;

  const LensletLattice& lattice_;
  const ImageModelOptions options_;
  const std::vector<float> filter_;  // diffraction, along one axis
  const std::int32_t width_, height_, reach_;
  const float pixel_mm_, focal_mm_, axis_x_px_, axis_y_px_;
  const double per_pupil_distance_, slope_sigma_;
  const std::vector<double> rim_shift_, rim_radius_mm_;
  std::vector<float> planes_, line_;  // workspace: the sharp image and its derivatives; one plane half blurred
  bool overlap_ = false;
  std::vector<Patch> patches_;  // room for them; a copy of the model has it, too
  std::size_t patch_count_ = 0;
  std::vector<std::uint32_t> place_;  // where a pixel of the box stands in the image, plus 1
};

}  // namespace rptv
