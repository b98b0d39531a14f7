// SPDX-License-Identifier: MIT
// Projections of a bundle against the camera model, and their derivatives against differences.
#include "calibration/cameras/bundle_projection.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "calibration/cameras/bundle.hpp"
#include "calibration/cameras/camera_graph.hpp"
#include "calibration/space_algebra.hpp"
#include "tests/calibration/cameras/sample_cameras.hpp"

namespace rptv {
namespace {

struct Drawn {
  LensParameters lens{};
  PoseParameters camera{}, target{};
  StackParameters move{};
  RefractiveStack stack;
  bool in_camera = false;
  Point3 point{};

  /// Pixel where the point is seen.
  bool project(Pixel& pixel, ProjectionDerivatives* derivatives = nullptr) const {
    const BrownDistortion distortion = distortion_of(lens);
    return BundleProjection{lens, camera, target, &stack, move, &distortion, in_camera}.project(point, pixel,
                                                                                                derivatives);
  }
};

/// `own`: the walls are given in the camera's frame.
Drawn draw(bool tank, bool own = false) {
  Drawn d;
  d.lens = parameters_of(drawn_lens());
  d.camera = parameters_of(drawn_pose());
  for (std::size_t k = 0; k < 6; ++k) d.target[k] = *real(-1, 1) * (k < 3 ? 0.8 : 10);
  if (tank) {
    d.stack = drawn_tank();
    if (own) {
      const CameraPose pose = pose_of(d.camera);
      d.in_camera = true;
      d.stack.normal = pose.rotation * d.stack.normal;
      for (auto& interface : d.stack.interfaces) interface.position_mm += dot(d.stack.normal, pose.translation_mm);
    }
    d.move = {*real(-0.05, 0.05), *real(-0.05, 0.05), *real(-3, 3)};
  }
  d.point = {*real(-30, 30), *real(-30, 30), *real(-10, 10)};
  return d;
}

void agrees_with_the_model(const Drawn& d) {
  CameraIntrinsics like;
  like.width_px = 1280, like.height_px = 1024;
  const RefractiveStack walls = d.stack.interfaces.empty() ? d.stack : moved(d.stack, d.move);
  Bundle bundle;
  bundle.cameras = {pose_of(d.camera)};
  (d.in_camera ? bundle.windows.emplace_back() : bundle.stack) = walls;
  const CameraModel model(lens_of(d.lens, like), bundle.cameras[0], stack_of(bundle, 0));
  const CameraPose target = pose_of(d.target);
  const auto expected = model.project(target.rotation * d.point + target.translation_mm);
  Pixel pixel;
  RC_ASSERT(d.project(pixel) == expected.has_value());
  RC_PRE(expected.has_value());
  RC_ASSERT(std::hypot(pixel[0] - (*expected)[0], pixel[1] - (*expected)[1]) < 1e-7);
}

/// Central differences of every parameter in `values`, against `derivatives` (2 rows).
template <std::size_t N>
void agrees_with_differences(const Drawn& d, std::array<double, N> Drawn::*values,
                             const std::array<double, 2 * N>& derivatives) {
  for (std::size_t k = 0; k < N; ++k) {
    const double step = 1e-6 * std::max(1.0, std::abs((d.*values)[k]));
    Drawn above = d, below = d;
    (above.*values)[k] += step, (below.*values)[k] -= step;
    Pixel high, low;
    RC_PRE(above.project(high) && below.project(low));
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double difference = (high[axis] - low[axis]) / (2 * step), exact = derivatives[axis * N + k];
      RC_ASSERT(std::abs(difference - exact) <= 1e-4 * std::max(std::abs(exact), 1.0));
    }
  }
}

void derivatives_are_right(const Drawn& d) {
  Pixel pixel;
  ProjectionDerivatives by;
  RC_PRE(d.project(pixel, &by));
  agrees_with_differences(d, &Drawn::lens, by.by_lens);
  agrees_with_differences(d, &Drawn::camera, by.by_camera);
  agrees_with_differences(d, &Drawn::target, by.by_target);
  if (!d.stack.interfaces.empty()) agrees_with_differences(d, &Drawn::move, by.by_stack);
}

RC_GTEST_PROP(BundleProjection, sees_what_the_camera_model_sees, ()) {
  agrees_with_the_model(draw(*rc::gen::arbitrary<bool>(), *rc::gen::arbitrary<bool>()));
}

RC_GTEST_PROP(BundleProjection, has_the_derivatives_that_differences_show_in_air, ()) {
  derivatives_are_right(draw(false));
}

RC_GTEST_PROP(BundleProjection, has_the_derivatives_that_differences_show_behind_glass, ()) {
  derivatives_are_right(draw(true));
}

RC_GTEST_PROP(BundleProjection, has_the_derivatives_that_differences_show_behind_a_window_of_its_own, ()) {
  derivatives_are_right(draw(true, true));
}

RC_GTEST_PROP(BundleProjection, keeps_poses_through_their_parameters, ()) {
  const CameraPose pose = drawn_pose(), again = pose_of(parameters_of(pose));
  RC_ASSERT(angle_deg(again.rotation * transpose(pose.rotation)) < 1e-6);
  RC_ASSERT(norm(again.translation_mm - pose.translation_mm) < 1e-9);
}

}  // namespace
}  // namespace rptv
