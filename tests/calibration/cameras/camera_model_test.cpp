// SPDX-License-Identifier: MIT
// Projection and sight rays against each other, against geometry by hand, and against numerical derivatives.
#include "calibration/cameras/camera_model.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <numbers>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "tests/calibration/cameras/sample_cameras.hpp"
#include "tests/core/allocation_counter.hpp"

namespace rptv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double distance(const SightRay& ray, const Point3& point) { return norm(cross(point - ray.origin_mm, ray.direction)); }

CameraIntrinsics plain() { return {1280, 1024, 5800, 5800, 639.5, 511.5}; }

RefractiveStack tank() { return {{0, 0, 1}, {1.0}, {{131, {1.46}}, {125, {1.33}}}}; }

CameraPose in_front() { return looking_at({0, 0, 600}, {0, 0, 0}, 0); }

std::string refusal(const CameraIntrinsics& lens, const CameraPose& pose, const RefractiveStack& stack = {}) {
  try {
    CameraModel(lens, pose, stack, "rig.toml: camera_1");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    return error.what();
  }
  return "";
}

RC_GTEST_PROP(CameraModel, the_ray_of_a_seen_point_passes_through_it, ()) {
  const CameraModel camera = drawn_camera();
  const Point3 point = drawn_point();
  const auto pixel = camera.project(point);
  RC_PRE(pixel.has_value());
  const SightRay ray = camera.ray(*pixel);
  RC_ASSERT(ray.valid());
  RC_ASSERT(distance(ray, point) < 1e-8);
  RC_ASSERT(dot(point - ray.origin_mm, ray.direction) > 0);
  RC_ASSERT(std::abs(norm(ray.direction) - 1) < 1e-12);
}

RC_GTEST_PROP(CameraModel, every_point_of_a_pixels_ray_is_seen_at_that_pixel, ()) {
  const CameraModel camera = drawn_camera();
  const Pixel pixel{*real(-0.5, 1279.5), *real(-0.5, 1023.5)};
  const SightRay ray = camera.ray(pixel);
  RC_PRE(ray.valid());
  const auto seen = camera.project(ray.origin_mm + *real(1, 1000) * ray.direction);
  RC_ASSERT(seen.has_value());
  RC_ASSERT(std::hypot((*seen)[0] - pixel[0], (*seen)[1] - pixel[1]) < 1e-8);
}

RC_GTEST_PROP(CameraModel, the_jacobian_is_the_derivative, ()) {
  const CameraModel camera = drawn_camera();
  const Point3 point = drawn_point();
  PixelJacobian jacobian{};
  const auto pixel = camera.project(point, jacobian);
  RC_PRE(pixel.has_value());
  RC_ASSERT(*pixel == *camera.project(point));
  constexpr double kStep = 1e-3;
  for (std::size_t k = 0; k < 3; ++k) {
    // fourth order: its own error is 1e-12 of the third derivative, and rounding 1e-10 px/mm
    const auto at = [&](double steps) {
      Point3 moved = point;
      moved[k] += steps * kStep;
      return *camera.project(moved);
    };
    const Pixel a = at(-2), b = at(-1), c = at(1), d = at(2);
    for (std::size_t i = 0; i < 2; ++i)
      RC_ASSERT(std::abs(jacobian[i][k] - (a[i] - 8 * b[i] + 8 * c[i] - d[i]) / (12 * kStep)) < 1e-7);
  }
}

TEST(CameraModel, a_pinhole_scales_by_focal_length_over_distance) {
  const CameraModel camera(plain(), {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {0, 0, 600}});
  EXPECT_EQ(camera.centre_mm(), (Point3{0, 0, -600}));
  const auto pixel = camera.project({12, -6, 0});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR((*pixel)[0], 639.5 + 5800 * 12 / 600.0, 1e-12);
  EXPECT_NEAR((*pixel)[1], 511.5 - 5800 * 6 / 600.0, 1e-12);
  EXPECT_FALSE(camera.project({0, 0, -601})) << "behind the camera";
}

TEST(CameraModel, light_obeys_snells_law_through_glass_into_water) {
  const CameraModel camera(plain(), in_front(), tank());
  const double in_air = 0.05;  // angle to the normal
  const SightRay ray = camera.ray({639.5 + 5800 * std::tan(in_air), 511.5});
  const double in_glass = std::asin(std::sin(in_air) / 1.46), in_water = std::asin(std::sin(in_air) / 1.33);
  EXPECT_NEAR(std::abs(ray.origin_mm[0]), 469 * std::tan(in_air) + 6 * std::tan(in_glass), 1e-10);
  EXPECT_NEAR(ray.origin_mm[2], 125, 1e-10);
  EXPECT_NEAR(std::abs(ray.direction[0]), std::sin(in_water), 1e-14);
  EXPECT_NEAR(ray.direction[2], -std::cos(in_water), 1e-14);
}

TEST(CameraModel, interfaces_between_equal_media_change_nothing) {
  const CameraModel with(plain(), in_front(), {{0, 0, 1}, {1.0}, {{131, {1.0}}, {125, {1.0}}}});
  const CameraModel without(plain(), in_front());
  const Point3 point{20, -15, 10};
  EXPECT_NEAR((*with.project(point))[0], (*without.project(point))[0], 1e-10);
  EXPECT_NEAR((*with.project(point))[1], (*without.project(point))[1], 1e-10);
}

TEST(CameraModel, a_point_moves_through_an_interface_without_a_jump) {
  const CameraModel camera(plain(), in_front(), tank());
  for (const double z : {131.0, 125.0}) {
    const auto before = camera.project({12, 7, z + 1e-9}), behind = camera.project({12, 7, z - 1e-9});
    EXPECT_NEAR((*before)[0], (*behind)[0], 1e-6);
    EXPECT_NEAR((*before)[1], (*behind)[1], 1e-6);
  }
}

TEST(CameraModel, projecting_and_looking_back_allocate_nothing) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer's allocator cannot be counted";
  CameraIntrinsics lens = plain();
  lens.k1 = -0.2, lens.p1 = 1e-3;
  const CameraModel camera(lens, in_front(), tank());
  AllocationCounter counter;
  PixelJacobian jacobian{};
  int seen = 0;
  for (double x = -600; x <= 600; x += 10) {
    seen += camera.project({x, 3, 4}, jacobian).has_value() ? 1 : 0;
    seen += camera.ray({x, 2 * x}).valid() ? 1 : 0;
  }
  EXPECT_EQ(counter.disarm(), 0U);
  EXPECT_GT(seen, 120);
}

TEST(CameraModel, grazing_light_and_total_reflection_have_no_ray) {
  const CameraModel from_water(plain(), looking_at({0, 0, 600}, {600, 0, 131}, 0), {{0, 0, 1}, {1.33}, {{131, {1.0}}}});
  EXPECT_FALSE(from_water.ray({639.5, 511.5}).valid()) << "52 degrees, beyond the critical 48.8";
  const CameraModel sideways(plain(), looking_at({0, 0, 600}, {600, 0, 600}, 0), tank());
  EXPECT_FALSE(sideways.ray({639.5, 511.5}).valid());
  const CameraModel nowhere(plain(), in_front(), tank());
  EXPECT_FALSE(nowhere.project({kInfinity, 0, 0}));
  EXPECT_FALSE(nowhere.project({std::nan(""), 0, 0}));
}

TEST(CameraModel, refuses_pixels_and_points_beyond_the_fold_of_the_distortion) {
  CameraIntrinsics lens = plain();
  lens.fx_px = lens.fy_px = 800, lens.k1 = -0.5;  // r - r³/2 turns at r = 0.816, where it is 0.544
  const CameraModel camera(lens, in_front());
  EXPECT_TRUE(camera.ray({639.5 + 800 * 0.543, 511.5}).valid());
  EXPECT_FALSE(camera.ray({639.5 + 800 * 0.546, 511.5}).valid());
  EXPECT_TRUE(camera.project({0.81 * 600, 0, 0}));
  EXPECT_FALSE(camera.project({0.82 * 600, 0, 0}));
}

TEST(CameraModel, says_in_a_line_what_no_camera_can_be) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_TRUE(text.starts_with("rig.toml: camera_1: ")) << text;
  };
  CameraIntrinsics lens = plain();
  lens.height_px = 0;
  says(refusal(lens, in_front()), "1280x0");
  lens = plain(), lens.fy_px = -1;
  says(refusal(lens, in_front()), "-1");
  lens = plain(), lens.k3 = kInfinity;
  says(refusal(lens, in_front()), "inf");
  CameraPose pose = in_front();
  pose.rotation[1] = 1.001 * pose.rotation[1];
  says(refusal(plain(), pose), "the rotation is none");
  pose = in_front(), pose.rotation[0][0] = std::nan("");
  says(refusal(plain(), pose), "the rotation is none");
  pose = in_front(), pose.rotation[1] = -1.0 * pose.rotation[1];
  says(refusal(plain(), pose), "mirrors");
  RefractiveStack stack = tank();
  stack.interfaces[1].position_mm = 140;
  says(refusal(plain(), in_front(), stack), "140 mm");
  stack = tank(), stack.interfaces[0].position_mm = 700;
  says(refusal(plain(), in_front(), stack), "700 mm");
  stack = tank(), stack.normal = {0, 0, 2};
  says(refusal(plain(), in_front(), stack), "length 2");
  stack = tank(), stack.interfaces[1].behind.index = 0.5;
  says(refusal(plain(), in_front(), stack), "0.5");
  stack = tank(), stack.interfaces.resize(9);
  says(refusal(plain(), in_front(), stack), "9 interfaces");
}

}  // namespace
}  // namespace rptv
