// SPDX-License-Identifier: MIT
// Images of a light-field camera: expected photoelectrons by quadrature over rays, then the camera's noise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "simulation/exposure.hpp"
#include "simulation/optics.hpp"
#include "simulation/quadrature.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/tracers.hpp"

namespace rptv {

/// What became of one particle's light in the last render().
struct TracerLight {
  double photoelectrons = 0;  ///< expected, through the lens, wherever they land
  bool in_view = false;       ///< its whole image is on the sensor
};

/// Renders frames and white images of one scenario (Exposure makes those without light). Every image depends on the
/// scenario and its frame number only. One thread per object: it owns a workspace; copies are cheap enough to have one
/// per thread.
class LightFieldRenderer {
 public:
  explicit LightFieldRenderer(const ScenarioSettings& scenario);

  ImageShape shape() const noexcept { return shape_; }
  std::uint32_t bits() const noexcept { return static_cast<std::uint32_t>(scenario_.camera.bits); }
  const LightFieldOptics& optics() const noexcept { return optics_; }

  /// Draws the particles as seen in `frame` into `pixels` (shape().bytes() long, uint8 or uint16, rows from the top).
  void render(std::span<const Tracer> tracers, std::uint64_t frame, std::span<std::byte> pixels);
  /// Evenly lit exit pupil: one spot per lenslet, `peak` of full scale, with noise.
  void render_white(double peak, std::span<std::byte> pixels);
  /// Whole image of the particle is on the sensor, a pixel from the border.
  bool in_view(const Vector3& object) noexcept;
  /// Of the last render(), in the order of its tracers.
  std::span<const TracerLight> lights() const noexcept { return lights_; }
  /// Rays that one particle takes, and one lenslet of a white image.
  std::size_t rays() const noexcept { return samples_.size(); }

  /// Expected photoelectrons per pixel of the last render() or render_white(), without stray light; row-major.
  std::span<const float> expected() const noexcept { return expected_; }

 private:
  void add_particle(const Vector3& object, double turn_rad);
  bool lands_inside(const SensorPoint& at) const noexcept;
  void add_light(const SensorPoint& at, float photoelectrons) noexcept;

  ScenarioSettings scenario_;
  LightFieldOptics optics_;
  ImageShape shape_;
  Exposure exposure_;
  std::vector<RaySample> samples_;
  std::vector<ArrayRay> rays_;  ///< workspace, one per sample
  std::vector<SensorMm> landings_;
  std::vector<TracerLight> lights_;
  double zero_px_ = 0;         ///< diffraction: first zero of the sinc; 0: none
  int reach_px_ = 0;           ///< the diffraction kernel spans 2 reach + 1 pixels
  std::vector<float> kernel_;  ///< [sub-pixel offset][2 reach + 1], each row sums to 1
  std::vector<float> expected_;
};

}  // namespace rptv
