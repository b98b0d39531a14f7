// SPDX-License-Identifier: MIT
// Cameras that were pushed by some pixels are put right by nothing but particles.
#include "calibration/cameras/self_calibration.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "calibration/cameras/eigen_space.hpp"
#include "calibration/cameras/rig_accuracy.hpp"
#include "core/error.hpp"
#include "reconstruct/multi_view/gather_disparities.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A camera turned about its own centre (rad, about its axes) and shifted (mm, along them).
CameraModel pushed(const CameraModel& model, const Point3& turn_rad, const Point3& shift_mm) {
  const auto [a, b, c] = turn_rad;
  const Matrix3 x{{{1, 0, 0}, {0, std::cos(a), -std::sin(a)}, {0, std::sin(a), std::cos(a)}}};
  const Matrix3 y{{{std::cos(b), 0, std::sin(b)}, {0, 1, 0}, {-std::sin(b), 0, std::cos(b)}}};
  const Matrix3 z{{{std::cos(c), -std::sin(c), 0}, {std::sin(c), std::cos(c), 0}, {0, 0, 1}}};
  const Matrix3 turn = x * y * z;
  return CameraModel(model.intrinsics(), {turn * model.pose().rotation, turn * model.pose().translation_mm + shift_mm},
                     model.stack());
}

/// About so many pixels in a random direction, by turning and by shifting.
Rig push(Rig rig, const std::vector<std::size_t>& cameras, double by_px, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> direction(0, 2 * M_PI), side(-1, 1);
  for (const std::size_t c : cameras) {
    const double a = direction(random), turn = by_px / 4640, roll = side(random) * by_px / 1000;
    rig.cameras[c].model = pushed(rig.cameras[c].model, {0.8 * turn * std::cos(a), 0.8 * turn * std::sin(a), roll},
                                  {0.2 * turn * 1000 * std::sin(a), -0.2 * turn * 1000 * std::cos(a), 0});
  }
  return rig;
}

/// Frames of new particles, by a true rig.
std::vector<ParticleImages> look(const Rig& rig, std::size_t frames, std::size_t particles, double noise_px,
                                 double missed = 0) {
  std::vector<ParticleImages> seen;
  std::mt19937 random(5);
  std::normal_distribution<double> light(0, 0.2);
  for (unsigned f = 0; f < frames; ++f) {
    ViewScene scene{rig, {{-100, -100, -100}, {100, 100, 100}}, {}, {}, {}};
    look(scene, particles, noise_px, missed, 11 + f, 100);
    for (std::size_t v = 0; v < rig.cameras.size(); ++v)  // light differs by particle, and by camera a little
      for (std::size_t i = 0; i < particles; ++i)
        if (const auto d = scene.tuples[i].detection[v]; d != kUnseen)
          scene.detections[v].grey[d] = std::exp(0.5 * std::sin(1e3 * static_cast<double>(i)) + light(random));
    seen.push_back(images_of(scene.detections));
  }
  return seen;
}

const Volume kVolume{{-100, -100, -100}, {100, 100, 100}};

SelfCalibration calibrate(const Rig& start, const std::vector<ParticleImages>& seen, double search_px) {
  const auto gather = [&](const Rig& rig, DisparityMaps& maps) {
    const DisparitySearch search{kVolume, std::min<std::size_t>(rig.cameras.size(), 4)};
    gather_disparities(rig, search, seen, maps);
  };
  const SelfCalibrationOptions options{CameraFreedom::pose, search_px};
  return self_calibrate(start, {kVolume.from, kVolume.to}, options, gather, "rig.toml");
}

void expect_residuals_below(const SelfCalibration& found, double limit_px) {
  for (std::size_t c = 0; c < found.after.size(); ++c) {
    EXPECT_EQ(found.after[c].parts, 24U) << c;
    EXPECT_LT(found.after[c].median_px, 0.2 * limit_px) << c;
    EXPECT_LT(found.after[c].worst_px, limit_px) << c;
  }
}

/// Largest distance between where two rigs see points of the volume, px.
double apart_px(const CameraModel& a, const CameraModel& b) {
  double largest = 0;
  for (const double x : {-90.0, 0.0, 90.0})
    for (const double y : {-90.0, 0.0, 90.0})
      for (const double z : {-90.0, 0.0, 90.0}) {
        const Pixel p = *a.project({x, y, z}), q = *b.project({x, y, z});
        largest = std::max(largest, std::hypot(p[0] - q[0], p[1] - q[1]));
      }
  return largest;
}

/// Where a rig sees particles of another, less the motion and the scale of the whole that fit best: rms, mm.
double warp_mm(const Rig& rig, const Rig& truth) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-90, 90);
  constexpr int kPoints = 200;
  Eigen::Matrix3Xd found(3, kPoints), true_places(3, kPoints);
  for (int i = 0; i < kPoints; ++i) {
    const Point3 at{place(random), place(random), place(random)};
    std::vector<Sighting> seen;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c)
      seen.push_back({&rig.cameras[c].model, *truth.cameras[c].model.project(at)});
    found.col(i) = vector_of(*triangulate(seen)), true_places.col(i) = vector_of(at);
  }
  const Eigen::Matrix4d move = Eigen::umeyama(found, true_places, true);
  const Eigen::Matrix3Xd moved =
      (move.topLeftCorner<3, 3>() * found).colwise() + Eigen::Vector3d(move.topRightCorner<3, 1>());
  return std::sqrt((moved - true_places).colwise().squaredNorm().mean());
}

TEST(SelfCalibration, finds_the_one_camera_that_was_pushed) {
  const Rig truth = make_rig(4), start = push(truth, {2}, 5, 1);
  EXPECT_GT(apart_px(start.cameras[2].model, truth.cameras[2].model), 5);
  const auto found = calibrate(start, look(truth, 2, 3900, 0.1), 6);  // 0.005 particles per pixel
  expect_residuals_below(found, 0.05);
  EXPECT_GT(found.before[2].median_px, 3);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_LT(apart_px(found.rig.cameras[c].model, truth.cameras[c].model), 0.1) << c;
}

TEST(SelfCalibration, puts_right_what_was_pushed_all_over_among_many_particles) {
  const Rig truth = make_rig(4), start = push(truth, {0, 1, 2, 3}, 2, 2);
  const auto found = calibrate(start, look(truth, 2, 15600, 0.1), 3);  // 0.02 particles per pixel
  expect_residuals_below(found, 0.05);
  EXPECT_GT(warp_mm(start, truth), 0.05);
  EXPECT_LT(warp_mm(found.rig, truth), 0.003);
}

TEST(SelfCalibration, sees_through_the_glass_of_a_tank) {
  const Rig truth = make_rig(4, true), start = push(truth, {3}, 3, 3);
  const auto found = calibrate(start, look(truth, 3, 3900, 0.1), 5);
  expect_residuals_below(found, 0.05);
  for (std::size_t c = 0; c < 4; ++c)
    EXPECT_LT(apart_px(found.rig.cameras[c].model, truth.cameras[c].model), 0.15) << c;
}

TEST(SelfCalibration, takes_particles_that_not_all_of_six_cameras_see) {
  const Rig truth = make_rig(6), start = push(truth, {0, 4}, 1, 4);
  const auto found = calibrate(start, look(truth, 3, 2000, 0.1, 0.1), 2);
  expect_residuals_below(found, 0.05);
  for (std::size_t c = 0; c < 6; ++c)
    EXPECT_LT(apart_px(found.rig.cameras[c].model, truth.cameras[c].model), 0.15) << c;
}

TEST(SelfCalibration, refuses_what_it_cannot_tell) {
  const Rig truth = make_rig(4);
  const auto why_not = [&](const Rig& start, const std::vector<ParticleImages>& seen, double search_px) {
    try {
      calibrate(start, seen, search_px);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_data);
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(why_not(truth, look(truth, 1, 100, 0.1), 2),
              AllOf(HasSubstr("rig.toml: camera 'view0' has a clear disparity within 1 px in 0 of 24 parts"),
                    HasSubstr("give more images")));
  const Rig far = push(truth, {1}, 30, 1);
  EXPECT_THAT(why_not(far, look(truth, 2, 2000, 0.1), 2), HasSubstr("search farther"));
}

}  // namespace
}  // namespace rptv::testing
