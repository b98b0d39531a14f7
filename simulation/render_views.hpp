// SPDX-License-Identifier: MIT
// Images of one camera of a rig: Gaussian particle images where the camera model projects them, then the camera's
// noise.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "calibration/cameras/camera_model.hpp"
#include "core/image.hpp"
#include "simulation/exposure.hpp"
#include "simulation/scenario.hpp"
#include "simulation/tracers.hpp"

namespace rptv {

/// Where a particle is seen in the last render().
struct ViewOfTracer {
  Pixel pixel{};         ///< NaN where the camera cannot see it
  bool in_view = false;  ///< three sigma of its image, and more, on the sensor
};

/// Renders the frames of one camera. An image depends on the scenario, the camera's number and the frame only. Tracers'
/// object space is the rig's frame. One thread per object; copies are cheap.
class ViewRenderer {
 public:
  /// `camera` counts the rig's cameras from 0 and keeps their noise apart.
  ViewRenderer(const ScenarioSettings& scenario, const CameraModel& model, std::uint64_t camera);

  ImageShape shape() const noexcept { return exposure_.shape(); }
  /// Draws the particles as seen in `frame` into `pixels` (shape().bytes() long, uint8 or uint16, rows from the top).
  void render(std::span<const Tracer> tracers, std::uint64_t frame, std::span<std::byte> pixels);
  /// Where it would be seen.
  ViewOfTracer view_of(const Tracer& tracer) const noexcept;
  /// Of the last render(), in the order of its tracers.
  std::span<const ViewOfTracer> views() const noexcept { return views_; }
  /// Expected photoelectrons per pixel of the last render(), without stray light; row-major.
  std::span<const float> expected() const noexcept { return expected_; }

 private:
  void add_image(const Pixel& at) noexcept;

  double photoelectrons_, sigma_px_;
  CameraModel model_;
  std::uint64_t stream_;
  Exposure exposure_;
  std::vector<ViewOfTracer> views_;
  std::vector<float> expected_;
};

}  // namespace rptv
