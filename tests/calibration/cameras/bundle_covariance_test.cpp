// SPDX-License-Identifier: MIT
// What an adjustment says about its own errors, against many adjustments of the same rig with other noise.
#include "calibration/cameras/bundle_covariance.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>

#include "calibration/cameras/eigen_space.hpp"
#include "calibration/cameras/rig_accuracy.hpp"
#include "calibration/cameras/volume_accuracy.hpp"
#include "tests/calibration/cameras/board_rig.hpp"

namespace rptv {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::size_t> kAll{0, 1, 2, 3};

/// The truth in the first camera's frame, where adjustments find it.
Bundle from_first(const BoardRig& rig) { return in_frame(rig.truth, inverse(rig.truth.cameras[0])); }

BoardSet with_noise(BoardSet set, double noise_px, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, noise_px);
  for (auto& image : set.images)
    for (auto& seen : image.seen) seen.pixel[0] += noise(random), seen.pixel[1] += noise(random);
  return set;
}

/// Cameras with one parameter moved by `step`, and the rig's frame in theirs.
std::pair<std::vector<CameraModel>, CameraPose> with_step(BundleCovariance c, const Bundle& like, std::size_t parameter,
                                                          double step) {
  if (parameter >= c.frame_at())
    c.frame[parameter - c.frame_at()] += step;
  else if (parameter >= c.stack_at())
    c.stack[parameter - c.stack_at()] += step;
  else if (parameter >= c.pose_at(0))
    c.cameras[(parameter - c.pose_at(0)) / 6][(parameter - c.pose_at(0)) % 6] += step;
  else
    c.lenses[parameter / 9][parameter % 9] += step;
  Bundle bundle = like;
  for (std::size_t k = 0; k < c.lenses.size(); ++k)
    bundle.lenses[k] = lens_of(c.lenses[k], like.lenses[k]), bundle.cameras[k] = pose_of(c.cameras[k]);
  if (!c.walls.stack.interfaces.empty()) bundle.stack = moved(c.walls.stack, c.stack);
  return {models_of(bundle), pose_of(c.frame)};
}

void expect_numerical_derivatives(const BundleResult& result) {
  const BundleCovariance& c = result.covariance;
  Bundle like = result.bundle;
  const Point3 point{8, -15, 20};
  const CameraPose frame = pose_of(c.frame);
  std::vector<Pixel> pixels;
  for (const auto& model : models_of(like))
    pixels.push_back(*model.project(after(frame, CameraPose{{}, point}).translation_mm));
  const auto exact = point_by_parameters(c, kAll, point);
  ASSERT_TRUE(exact);
  const auto found_with = [&](std::size_t parameter, double step) {
    const auto [models, to_adjusted] = with_step(c, like, parameter, step);
    std::vector<Sighting> sightings;
    for (std::size_t k = 0; k < models.size(); ++k) sightings.push_back({&models[k], pixels[k]});
    const Point3 found = triangulate(sightings).value();
    return transpose(to_adjusted.rotation) * (found - to_adjusted.translation_mm);
  };
  for (std::size_t k = 0; k < c.size(); ++k) {
    const bool angle = k >= c.pose_at(0) && (k >= c.stack_at() || (k - c.pose_at(0)) % 6 < 3);
    const double step = angle || k % 9 > 3 ? 1e-5 : 1e-3;
    const Point3 slope = (0.5 / step) * (found_with(k, step) - found_with(k, -step));
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR((*exact)[axis * c.size() + k], slope[axis], 1e-4 * (norm(slope) + 1e-2)) << k << " axis " << axis;
  }
}

TEST(BundleCovariance, knows_how_points_move_with_every_parameter) {
  const BoardRig in_air(small_board().points(), 5, 0.01);
  BundleOptions options;
  options.frame_view = 2;
  expect_numerical_derivatives(adjust_bundle(in_air.set, from_first(in_air), options));
  const BoardRig in_water(small_board().points(), 6, 0.01, 0.6, {{0, 0, -1}, {1.0}, {{130, {1.46}}, {120, {1.33}}}});
  options.fit_stack = true;
  expect_numerical_derivatives(adjust_bundle(in_water.set, from_first(in_water), options));
}

/// Places points by rigs that were adjusted to the same views with other noise each time.
/// Returns the mean of eᵀ·C⁻¹·e / 3: 1 where the errors are as large as expected and lie as expected.
double error_over_expectation(const BoardRig& exact, const BundleOptions& options, double noise_px) {
  constexpr unsigned kSeeds = 40;
  const std::vector<Point3> points{{0, 0, 0}, {35, -30, 25}, {-40, 20, -30}, {10, 40, 40}};
  const auto in_its_frame = [&](const Bundle& bundle) {
    return options.frame_view ? in_frame(bundle, CameraPose(*bundle.targets[*options.frame_view])) : bundle;
  };
  const Bundle start = from_first(exact), truth = in_its_frame(start);
  const CameraPose to_truth = after(inverse(truth.cameras[0]), exact.truth.cameras[0]);
  const auto true_models = models_of(truth);
  double sum = 0;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const BundleResult result = adjust_bundle(with_noise(exact.set, noise_px, seed), start, options);
    const auto models = models_of(in_its_frame(result.bundle));
    for (const Point3& at : points) {
      const Point3 point = to_truth.rotation * at + to_truth.translation_mm;
      std::vector<Sighting> sightings;
      for (std::size_t k : kAll) sightings.push_back({&models[k], *true_models[k].project(point)});
      const Eigen::Vector3d error = vector_of(triangulate(sightings).value() - point);
      const Eigen::Matrix3d expected = matrix_of(calibration_covariance_mm2(result.covariance, kAll, point).value());
      sum += error.dot(expected.inverse() * error) / 3;
    }
  }
  return sum / static_cast<double>(kSeeds * points.size());
}

TEST(BundleCovariance, expects_the_errors_that_calibrations_make_of_points) {
  const BoardRig rig(small_board().points(), 6, 0);
  EXPECT_NEAR(error_over_expectation(rig, {}, 0.05), 1, 0.25);
  BundleOptions on_board;
  on_board.frame_view = 3;
  EXPECT_NEAR(error_over_expectation(rig, on_board, 0.05), 1, 0.25);
}

TEST(BundleCovariance, expects_them_through_glass_that_is_fitted) {
  const BoardRig rig(small_board().points(), 6, 0, 0.6, {{0, 0, -1}, {1.0}, {{130, {1.46}}, {120, {1.33}}}});
  BundleOptions options;
  options.fit_stack = true;
  EXPECT_NEAR(error_over_expectation(rig, options, 0.02), 1, 0.25);
}

TEST(VolumeAccuracy, tells_errors_of_images_from_those_of_the_calibration) {
  const BoardRig rig(small_board().points(), 6, 0.05);
  const auto result = adjust_bundle(rig.set, from_first(rig), {});
  const VolumeAccuracy volume = volume_accuracy(rig.set, result);
  ASSERT_TRUE(volume.calibration && volume.together);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_GT(volume.together->worst_mm[axis], volume.detection.worst_mm[axis]);
    EXPECT_GT(volume.calibration->median_mm[axis], 0);
    EXPECT_LE(volume.together->worst_mm[axis],
              std::hypot(volume.detection.worst_mm[axis], volume.calibration->worst_mm[axis]) * (1 + 1e-12));
  }
  for (std::size_t axis = 0; axis < 2; ++axis)  // a turned first camera turns all that is seen
    EXPECT_LT(volume.shape->median_mm[axis], 0.5 * volume.calibration->median_mm[axis]);
  const VolumeAccuracy better = volume_accuracy(rig.set, result, 0.01);
  EXPECT_NEAR(better.detection.median_mm[2], 0.1 * volume.detection.median_mm[2], 1e-9);
  EXPECT_EQ(better.calibration->median_mm, volume.calibration->median_mm) << "whatever particles' images are";
  EXPECT_THAT(to_text(volume), AllOf(HasSubstr("by images"), HasSubstr("by calibration"), HasSubstr("of its shape"),
                                     HasSubstr("together")));
}

TEST(VolumeAccuracy, says_that_images_do_not_determine_the_cameras) {
  const BoardRig rig({{0, 0, 0}}, 20, 0.005);  // one point, which does not tell how the target is turned
  BundleOptions options;
  options.fit_lenses = false;
  const auto result = adjust_bundle(rig.set, from_first(rig), options);
  EXPECT_TRUE(result.covariance.values.empty());
  EXPECT_TRUE(result.lens_sigma.empty());
  const VolumeAccuracy volume = volume_accuracy(rig.set, result);
  EXPECT_FALSE(volume.calibration);
  EXPECT_THAT(to_text(volume),
              AllOf(HasSubstr("these images do not determine"), HasSubstr("take more views"), Not(HasSubstr("nan"))));
  EXPECT_THAT(to_json(volume), HasSubstr("\"calibration_median_mm\":null"));
}

}  // namespace
}  // namespace rptv
