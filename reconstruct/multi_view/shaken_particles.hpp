// SPDX-License-Identifier: MIT
// The particles of a frame set and the images of all views less theirs: all are moved until the images are explained.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/cameras/camera_model.hpp"
#include "core/particles.hpp"
#include "reconstruct/multi_view/residual_view.hpp"
#include "reconstruct/multi_view/view_rays.hpp"

namespace rptv {

/// Place in the rig's frame, mm; light in grey values of a view of mean brightness.
struct ShakenParticle {
  Point3 at_mm{};
  float grey = 0;
  float weakest = 0;        ///< light in the view that shows least of it
  std::uint32_t views = 0;  ///< whose images it is in
  double miss_px = 0;       ///< rms distance that single views would move it
  Covariance covariance_mm2{};
};

/// Particles move a part of them at a time against the same residual images, which then follow: the result does not
/// depend on the number of threads. All memory is taken by the constructor. One thread calls; parallel inside.
class ShakenParticles {
 public:
  static constexpr std::size_t kTellingParticles = 40;  ///< fewer do not tell what their images look like

  struct Options {
    std::size_t capacity = 16384, threads = 1;
    double sigma_px = 1;
  };
  ShakenParticles(std::vector<CameraModel> models, std::vector<ResidualView> views, const Volume& volume,
                  const Options& options);

  std::span<ResidualView> views() noexcept { return views_; }
  std::span<const ResidualView> views() const noexcept { return views_; }
  std::span<const ShakenParticle> all() const noexcept { return particles_; }

  void clear() noexcept { particles_.clear(), sweeps_ = 0; }
  /// False when full.
  bool push(const Point3& at_mm, float grey) noexcept;
  /// Makes the residual images anew.
  void subtract() noexcept;
  /// One step of every particle; the residual images follow.
  void sweep() noexcept;
  /// Fits width and brightness of each view's particle images to the residuals.
  void fit_images() noexcept;
  /// Lets go those with less than `share` of the median light in any view, and the fainter of two that are nearer than
  /// `apart_px`, and those that left the volume. The residuals stay as they are. Returns how many went.
  std::size_t drop(double share, double apart_px) noexcept;

  void set_sigma(std::size_t view, double sigma_px) noexcept { sigma_px_[view] = sigma_px; }
  double sigma_px(std::size_t view) const noexcept { return sigma_px_[view]; }
  double gain(std::size_t view) const noexcept { return gain_[view]; }
  double px_per_mm() const noexcept { return px_per_mm_; }
  float median_grey() noexcept;

 private:
  static constexpr std::size_t kBlock = 64;  // particles that a thread takes at once
  ViewSpot spot_of(const ShakenParticle& particle, std::size_t view, double sigma_px) const noexcept;
  void step(ShakenParticle& particle) const noexcept;
  void subtract(std::size_t view, double sigma_px) noexcept;
  void fit_image(std::size_t view) noexcept;
  bool inside(const Point3& at_mm) const noexcept;
  std::size_t keep() noexcept;

  std::vector<CameraModel> models_;
  std::vector<ResidualView> views_;
  Volume volume_;
  std::size_t capacity_, threads_;
  double px_per_mm_ = 0;
  std::size_t sweeps_ = 0;
  std::vector<double> sigma_px_, gain_;
  std::vector<ShakenParticle> particles_;
  std::vector<std::vector<ViewSpot>> spots_;  ///< by view, of all particles
  std::vector<std::vector<float>> misfits_;   ///< by view
  std::vector<float> greys_;
  std::vector<std::uint32_t> order_;
  std::vector<std::uint8_t> kept_;
};

}  // namespace rptv
