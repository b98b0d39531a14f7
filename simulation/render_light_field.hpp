// SPDX-License-Identifier: MIT
// Images of a light-field camera: expected photoelectrons by quadrature over rays, then the camera's noise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image.hpp"
#include "simulation/optics.hpp"
#include "simulation/random.hpp"
#include "simulation/scenario.hpp"
#include "simulation/tracers.hpp"

namespace rptv {

/// Renders frames, the white image and the dark image of one scenario. Every image depends on the scenario and its
/// frame number only. One thread per object: it owns a workspace; copies are cheap enough to have one per thread.
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
  /// Mean image without particles: black level and stray light, rounded, no noise.
  void render_background(std::span<std::byte> pixels) const;
  /// Whole image of the particle is on the sensor.
  bool in_view(const Vector3& object) const noexcept;

  /// Expected photoelectrons per pixel of the last render() or render_white(), without stray light; row-major.
  std::span<const float> expected() const noexcept { return expected_; }

 private:
  struct RaySample {
    float pupil_x, pupil_y;  ///< in the unit disc
    float body_x, body_y;    ///< in the unit disc
  };
  void add_particle(const Vector3& object, Random& random);
  void add_light(const SensorPoint& at, float photoelectrons) noexcept;
  void expose(std::uint64_t stream, std::span<std::byte> pixels) const;
  template <class Pixel>
  void expose_as(std::uint64_t stream, Pixel* pixels) const;

  ScenarioSettings scenario_;
  LightFieldOptics optics_;
  ImageShape shape_;
  std::vector<RaySample> rays_;
  int reach_px_ = 0;           ///< the diffraction kernel spans 2 reach + 1 pixels
  std::vector<float> kernel_;  ///< [sub-pixel offset][2 reach + 1], each row sums to 1
  std::vector<float> expected_;
};

}  // namespace rptv
