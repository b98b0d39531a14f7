// SPDX-License-Identifier: MIT
// Light-field reconstruction: lit pixels → rays → ray counter → candidates → N-ray least squares → object space.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "calibration/light_field/light_field_calibration.hpp"
#include "core/image.hpp"
#include "reconstruct/light_field/light_field_device.hpp"
#include "reconstruct/light_field/light_field_settings.hpp"
#include "reconstruct/light_field/particle_fit.hpp"
#include "reconstruct/reconstructor.hpp"

namespace rptv {

/// What was left out since construction, and how the last frame went. Read on the reconstructing thread, or after it.
struct LightFieldCounts {
  std::uint64_t frames = 0;
  std::uint64_t refused_frames = 0;      ///< not one camera, torn, or not the calibration's shape
  std::uint64_t refused_pixels = 0;      ///< lit pixels beyond max_rays
  std::uint64_t refused_candidates = 0;  ///< voxels beyond max_candidates, or candidates beyond their room
  std::uint64_t refused_particles = 0;   ///< beyond max_particles
  std::uint64_t rough_covariances = 0;   ///< of particles whose neighbours were too many to take all in
  std::uint64_t device_unsure = 0;       ///< times that the CPU explained rays since the device could not be sure
  bool device_failed = false;            ///< the CPU has done its work since
  std::size_t lit_pixels = 0, rays = 0, candidates = 0, rounds = 0;  ///< of the last frame
};

/// Reconstruction from one camera behind a microlens array, after eq. (5)-(9), (11) of Hong and Chamorro (Lab on a Chip
/// 22, 2022). Set-up takes all memory: tables of 4 bytes a pixel and hypothesis, the voxel volume, and max_rays.
class LightField final : public Reconstructor {
 public:
  /// Throws Error(configuration) when settings and calibration do not fit together. `background`: an image without
  /// particles, copied; without data, the constant settings.background is used, or the calibration's dark level where
  /// that is 0. `settings.calibration` and `settings.background_image` are not read here. `make_device`: another
  /// processor for the first steps, which needs settings.counting "coarse_to_fine"; the particles are the same.
  LightField(const LightFieldSettings& settings, const LightFieldCalibration& calibration, const ImageView& background,
             const MakeLightFieldDevice& make_device = nullptr);
  ~LightField() override;

  void reconstruct(const FrameSet& frames, Particles& out) noexcept override;
  std::size_t most_in_flight() const noexcept override;
  void submit(const FrameSet& frames) noexcept override;
  void collect(Particles& out) noexcept override;
  bool page_lock(std::span<std::byte> memory) noexcept override;
  /// The same for one image.
  void reconstruct(const ImageView& image, Particles& out) noexcept;
  void submit(const ImageView& image) noexcept;

  /// The last frame's particles as they were fitted, in image space; in the order of what reconstruct() gave out.
  std::span<const FittedParticle> fitted() const noexcept;
  const LightFieldCounts& counts() const noexcept;
  /// C_min in use: settings.min_count, or eq. (7).
  std::uint16_t min_count() const noexcept;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

/// C_min by eq. (7): half the pixels that a particle in focus lights; magnification by the calibration.
double min_count_by_eq7(const LightFieldCalibration& calibration, double particle_radius_um) noexcept;

}  // namespace rptv
