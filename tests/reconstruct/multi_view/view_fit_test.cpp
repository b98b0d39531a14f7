// SPDX-License-Identifier: MIT
// Rays by table against the exact cameras; the fit against the exact reprojection error; covariance against truth.
#include "reconstruct/multi_view/view_fit.hpp"

#include <gtest/gtest.h>

#include "reconstruct/multi_view/correspondence.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

using testing::ViewScene;

class ViewsBehind : public ::testing::TestWithParam<bool> {};

TEST_P(ViewsBehind, air_or_water_see_points_where_the_camera_does) {
  const ViewScene scene = testing::make_scene(4, 200, 0, 0, GetParam());
  const auto rays = testing::rays_of(scene);
  for (std::size_t v = 0; v < rays.size(); ++v) {
    EXPECT_LT(rays[v].table_error_px(), 0.005);
    for (std::size_t i = 0; i < scene.particles.size(); ++i) {
      const std::uint32_t number = scene.tuples[i].detection[v];
      if (number == kUnseen) continue;
      SeenRay ray;
      ASSERT_TRUE(rays[v].look(scene.detections[v].x_px[number], scene.detections[v].y_px[number], ray));
      const auto on_ray = miss_px(ray, rays[v].axes(), scene.particles[i]);
      EXPECT_LT(std::hypot(on_ray[0], on_ray[1]), 0.01);
      // A point beside the ray misses by what the exact camera says.
      const Point3 beside = scene.particles[i] + Point3{0.1, -0.2, 0.15};
      const auto miss = miss_px(ray, rays[v].axes(), beside);
      const auto pixel = scene.rig.cameras[v].model.project(beside);
      EXPECT_NEAR(miss[0], (*pixel)[0] - scene.detections[v].x_px[number], 0.01);
      EXPECT_NEAR(miss[1], (*pixel)[1] - scene.detections[v].y_px[number], 0.01);
    }
  }
}

double exact_cost(const ViewScene& scene, const ViewTuple& tuple, const Point3& at) {
  double cost = 0;
  for (std::size_t v = 0; v < scene.rig.cameras.size(); ++v) {
    if (tuple.detection[v] == kUnseen) continue;
    const auto pixel = scene.rig.cameras[v].model.project(at);
    cost += std::pow((*pixel)[0] - scene.detections[v].x_px[tuple.detection[v]], 2) +
            std::pow((*pixel)[1] - scene.detections[v].y_px[tuple.detection[v]], 2);
  }
  return cost;
}

TEST_P(ViewsBehind, air_or_water_are_fitted_to_the_least_reprojection_error_with_honest_covariance) {
  constexpr double kNoise_px = 0.3;
  const ViewScene scene = testing::make_scene(4, 600, kNoise_px, 0.1, GetParam());
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options;
  options.tolerance_px = 2;
  Correspondence correspondence(rays, scene.volume, options);
  double squares = 0, count = 0;
  for (const ViewMatch& match : correspondence.match(scene.detections)) {
    const auto truth = std::find(scene.tuples.begin(), scene.tuples.end(), match.tuple);
    if (truth == scene.tuples.end()) continue;
    const Particle found = fit_views(correspondence.views(), scene.detections, match, 0);
    const Point3 at{found.x_mm, found.y_mm, found.z_mm};
    const double least = exact_cost(scene, match.tuple, at);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const double step : {-0.01, 0.01}) {
        Point3 beside = at;
        beside[axis] += step;
        EXPECT_GT(exact_cost(scene, match.tuple, beside), least);
      }
    EXPECT_EQ(found.support, match.tuple.views);
    const auto& c = found.covariance_mm2;
    const Point3 error = at - scene.particles[static_cast<std::size_t>(truth - scene.tuples.begin())];
    squares += dot(error, inverse({{{c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4], c[5]}}}) * error);
    count += 1;
  }
  EXPECT_GT(count, 400);
  EXPECT_NEAR(squares / count, 3, 0.5);  // χ² of three coordinates; five standard errors of the mean
}

INSTANTIATE_TEST_SUITE_P(media, ViewsBehind, ::testing::Bool());

TEST(ViewRays, of_a_camera_that_looks_elsewhere_are_refused_by_name) {
  const Rig rig = testing::make_rig(2);
  try {
    const ViewRays rays(rig.cameras[0].model, {{0, 0, -3000}, {10, 10, -2900}}, rig.cameras[0].name);
    FAIL() << "no error";
  } catch (const std::exception& error) {
    EXPECT_NE(std::string(error.what()).find("camera 'view0' cannot see the volume's centre"), std::string::npos);
  }
}

}  // namespace
}  // namespace rptv
