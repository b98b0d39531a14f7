// SPDX-License-Identifier: MIT
// The polynomial map: derivatives, inverse, a lens that it must reproduce, points that do not fix it.
#include "calibration/light_field/fit_volume.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

LightFieldCalibration macro() {
  LightFieldCalibration c;
  c.sensor = {2048, 1536, 4.35, {}};
  c.lenslets.pitch_um = 125, c.lenslets.focal_length_mm = 3.75;
  c.lens.model = "thick_lens", c.lens.focal_length_mm = 50.358, c.lens.array_distance_mm = 100.716;
  c.lens.exit_pupil_mm = 104.2;
  return c;
}

/// A target of 7 x 7 dots on 5 depths through the thick lens, with a barrel distortion and noise.
std::vector<Correspondence> target(double noise_mm, int columns = 7, int rows = 7, int depths = 5) {
  const ObjectMap lens(macro());
  std::mt19937_64 random(8);
  std::normal_distribution<double> normal(0, noise_mm > 0 ? noise_mm : 1);
  std::vector<Correspondence> pairs;
  for (int k = 0; k < depths; ++k)
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        const double x = -4 + i * 8.0 / 6, y = -3 + j, z = -8 + 4 * k;
        const double bend = 1 - 1e-3 * (x * x + y * y);
        Correspondence pair{lens.to_image({x * bend, y * bend, z}), {x, y, z}};
        for (double& value : pair.image) value += noise_mm > 0 ? normal(random) : 0;
        pairs.push_back(pair);
      }
  return pairs;
}

std::string refusal_of(const std::vector<Correspondence>& pairs) {
  try {
    fit_volume(pairs, macro(), "pairs.csv");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_data);
    return error.what();
  }
  return "taken";
}

TEST(SoloffPolynomial, slopes_are_the_derivatives_of_the_terms) {
  const Point3 at{0.3, -0.7, 0.9};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Point3 low = at, high = at;
    low[axis] -= 1e-5, high[axis] += 1e-5;
    const auto slopes = soloff_slopes(at, axis), a = soloff_terms(low), b = soloff_terms(high);
    for (std::size_t k = 0; k < kSoloffTerms; ++k)
      EXPECT_NEAR(slopes[k], (b[k] - a[k]) / 2e-5, 1e-9) << axis << ' ' << k;
  }
}

TEST(FitVolume, the_fitted_map_has_its_jacobian_and_its_inverse) {
  const ObjectMap map(fit_volume(target(0), macro(), "pairs.csv").calibration);
  for (const Point3 image : {Point3{1, -2, 5}, {-3.5, 2, -6}, {0, 0, 0}}) {
    const Matrix3 jacobian = map.jacobian(image);
    for (std::size_t column = 0; column < 3; ++column) {
      Point3 low = image, high = image;
      low[column] -= 1e-4, high[column] += 1e-4;
      const Point3 a = map.to_object(low), b = map.to_object(high);
      for (std::size_t row = 0; row < 3; ++row) EXPECT_NEAR(jacobian[row][column], (b[row] - a[row]) / 2e-4, 1e-7);
    }
    const Point3 back = map.to_image(map.to_object(image));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], image[k], 1e-9);
  }
}

TEST(FitVolume, follows_a_distorting_lens_that_the_thick_lens_does_not) {
  const auto pairs = target(0);
  const VolumeFit fit = fit_volume(pairs, macro(), "pairs.csv");
  const VolumeResiduals before = residuals_of(ObjectMap(macro()), pairs);
  EXPECT_GT(before.largest, 0.05);
  EXPECT_LT(fit.residuals.largest, 0.01);
  EXPECT_LT(fit.residuals.rms[0], 0.001);
  EXPECT_EQ(fit.calibration.lens.model, "polynomial");
  EXPECT_NEAR(fit.calibration.magnification(), 1, 1e-3);
}

TEST(FitVolume, points_left_out_are_worse_than_points_fitted) {
  const auto noisy = target(0.01);
  const VolumeFit fit = fit_volume(noisy, macro(), "pairs.csv");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_GT(fit.left_out_rms[k], fit.residuals.rms[k]);
    EXPECT_LT(fit.left_out_rms[k], 0.03);
  }
}

TEST(FitVolume, may_be_told_again_with_its_own_result) {
  const auto pairs = target(0);
  const auto once = fit_volume(pairs, macro(), "pairs.csv");
  const auto twice = fit_volume(pairs, once.calibration, "pairs.csv");
  EXPECT_EQ(once.calibration.polynomial.object_z_mm, twice.calibration.polynomial.object_z_mm);
}

TEST(FitVolume, refuses_points_that_do_not_fix_the_polynomial) {
  EXPECT_THAT(refusal_of(target(0, 3, 3, 2)), HasSubstr("needs at least 25"));
  EXPECT_THAT(refusal_of(target(0, 7, 7, 1)), HasSubstr("all points have the same image_z"));
  EXPECT_THAT(refusal_of(target(0, 7, 7, 2)), HasSubstr("do not fix"));
  EXPECT_THAT(refusal_of(target(0, 3, 7, 5)), HasSubstr("do not fix"));
  auto flat = target(0);
  for (auto& pair : flat) pair.image[2] = 1;
  EXPECT_THAT(refusal_of(flat), HasSubstr("all points have the same image_z"));
}

TEST(Correspondences, are_read_by_name_and_refused_by_line) {
  const auto pairs = parse_correspondences(
      "object_x,object_y,object_z,image_x,image_y,image_z,note\n1,2,3,-1,-2,-3,a\n4,5,6,-4,-5,-6,b\n", "pairs.csv");
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[1].object, (Point3{4, 5, 6}));
  EXPECT_EQ(pairs[1].image, (Point3{-4, -5, -6}));
  EXPECT_THROW(parse_correspondences("image_x,image_y\n1,2\n", "pairs.csv"), Error);
  try {
    parse_correspondences("image_x,image_y,image_z,object_x,object_y,object_z\n1,2,3,4,5,1e9\n", "pairs.csv");
    FAIL();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("pairs.csv:2"));
  }
}

}  // namespace
}  // namespace rptv
