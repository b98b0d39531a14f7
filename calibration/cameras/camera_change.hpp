// SPDX-License-Identifier: MIT
// The numbers of a camera that a fit may change, scaled so that 1 moves its projections by about a pixel.
#pragma once

#include <span>
#include <vector>

#include "calibration/cameras/camera_model.hpp"

namespace rptv {

/// What is fitted of a camera; each includes those before it. Interfaces are held.
enum class CameraFreedom {
  pose,        ///< position and direction: 6 numbers
  focal,       ///< and one factor of fx and fy
  distortion,  ///< and k1, p1, p2
};

/// Changes of a model that must outlive this: rotation about the rig's origin and translation, in the camera's frame,
/// then what CameraFreedom adds. Set-up only.
class CameraChange {
 public:
  /// `distance_mm`: from the camera to what it sees.
  CameraChange(CameraFreedom freedom, const CameraModel& model, double distance_mm);

  std::size_t size() const noexcept { return scale_.size(); }
  /// Throws Error(configuration) where the change makes what no camera can be.
  CameraModel changed(std::span<const double> by) const;

 private:
  const CameraModel* model_;
  std::vector<double> scale_;
};

}  // namespace rptv
