// SPDX-License-Identifier: MIT
// Where the optical axes meet, and what can be seen round it.
#include "reconstruct/multi_view/seen_volume.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr int kSteps = 20;  // of the grid, to each side

[[noreturn]] void refuse() {
  throw Error(
      ExitCode::configuration,
      "the cameras of the rig look at no common place; give multi_view.volume_x_mm, volume_y_mm and volume_z_mm");
}

/// The point nearest to the rays of the middles of the images.
Point3 looked_at(const Rig& rig) {
  Matrix3 sum{};
  Point3 right{};
  for (const RigCamera& camera : rig.cameras) {
    const CameraIntrinsics& lens = camera.model.intrinsics();
    const SightRay ray = camera.model.ray({(lens.width_px - 1) / 2.0, (lens.height_px - 1) / 2.0});
    if (!ray.valid()) continue;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double across = (i == k ? 1 : 0) - ray.direction[i] * ray.direction[k];
        sum[i][k] += across;
        right[i] += across * ray.origin_mm[k];
      }
  }
  if (!(determinant(sum) > 1e-6)) refuse();
  return inverse(sum) * right;
}

std::size_t views_of(const Rig& rig, const Point3& at) {
  return static_cast<std::size_t>(std::count_if(rig.cameras.begin(), rig.cameras.end(), [&](const RigCamera& camera) {
    const auto pixel = camera.model.project(at);
    return pixel && camera.model.in_image(*pixel);
  }));
}

}  // namespace

Volume seen_volume(const Rig& rig, std::size_t min_views) {
  const Point3 middle = looked_at(rig);
  double reach = std::numeric_limits<double>::infinity();
  for (const RigCamera& camera : rig.cameras) reach = std::min(reach, 0.8 * norm(camera.model.centre_mm() - middle));
  const double step = reach / kSteps;
  Volume box{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  for (int i = -kSteps; i <= kSteps; ++i)
    for (int j = -kSteps; j <= kSteps; ++j)
      for (int k = -kSteps; k <= kSteps; ++k) {
        const Point3 at = middle + step * Point3{1.0 * i, 1.0 * j, 1.0 * k};
        if (views_of(rig, at) < min_views) continue;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          box.from[axis] = std::min(box.from[axis], at[axis] - step);
          box.to[axis] = std::max(box.to[axis], at[axis] + step);
        }
      }
  if (!(box.from[0] < box.to[0])) refuse();
  return box;
}

}  // namespace rptv
