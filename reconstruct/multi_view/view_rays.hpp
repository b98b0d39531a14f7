// SPDX-License-Identifier: MIT
// One view's sight rays by table: pixel → ray in the volume, with the px-to-mm footprint along it.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "calibration/cameras/camera_model.hpp"
#include "calibration/space.hpp"
#include "reconstruct/multi_view/seen_ray_kernel.hpp"

namespace rptv {

/// A box in the rig's frame, mm.
struct Volume {
  Point3 from{}, to{};
  Point3 centre() const noexcept { return {(from[0] + to[0]) / 2, (from[1] + to[1]) / 2, (from[2] + to[2]) / 2}; }
};

/// Immutable; any thread. Refraction and distortion are in the table, which is made from CameraModel::ray().
class ViewRays {
 public:
  /// Throws Error(configuration) when the camera `name` does not look into the volume.
  ViewRays(const CameraModel& model, const Volume& volume, const std::string& name);

  /// False for a pixel beyond the image or that no light from the volume reaches.
  bool look(double column, double row, SeenRay& ray) const noexcept;

  /// Axes of the view's frame in the rig's frame: about along columns, about along rows, away from the camera.
  const Matrix3& axes() const noexcept { return axes_; }

  /// The pinhole that fits the rays best. Where the camera sees through air, each ray is one point in it.
  const Projection& pinhole() const noexcept { return pinhole_; }
  /// Where that pinhole is, relative to the volume's centre.
  const Point3& pinhole_centre_mm() const noexcept { return pinhole_centre_mm_; }
  /// Image of a ray in pinhole(), at depth 0.
  std::array<double, 2> in_pinhole(const SeenRay& ray) const noexcept {
    return {scale_ * (ray.x - foot_x_mm_), scale_ * (ray.y - foot_y_mm_)};
  }
  /// How far a ray wanders in pinhole() between the depths, px: what refraction leaves.
  double wander_px() const noexcept { return wander_px_; }
  /// Largest difference between table and model between the nodes, px.
  double table_error_px() const noexcept { return table_error_px_; }
  /// Pixels per mm at the volume's centre.
  double px_per_mm() const noexcept { return scale_; }
  /// Range of in_pinhole() over the image: from column, row, to column, row.
  const std::array<double, 4>& pinhole_range() const noexcept { return range_; }

 private:
  struct Node {
    double x, y, dx, dy;
  };
  bool trace(const CameraModel& model, double column, double row, Node& node) const noexcept;
  void fill(const CameraModel& model, double step_px);
  double compare(const CameraModel& model) const;
  void fit_pinhole(const std::string& name);

  Point3 centre_mm_;
  Matrix3 axes_{};
  std::array<double, 2> depths_mm_{};  // that the volume spans
  double width_px_, height_px_;
  double step_px_ = 0;
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<Node> nodes_;
  Projection pinhole_{};
  Point3 pinhole_centre_mm_{};
  double scale_ = 0, foot_x_mm_ = 0, foot_y_mm_ = 0;
  double wander_px_ = 0, table_error_px_ = 0;
  std::array<double, 4> range_{};
};

}  // namespace rptv
