// SPDX-License-Identifier: MIT
// The map to object space against the lens formula, numerical derivatives and sampled covariances.
#include "calibration/light_field/object_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.hpp"

namespace rptv {
namespace {

LightFieldCalibration lens(const std::string& model, double index) {
  LightFieldCalibration c;
  c.sensor = {2048, 1536, 9.0, {}};
  c.lenslets.pitch_um = 125, c.lenslets.focal_length_mm = 3.75;
  c.lens.model = model, c.lens.medium_index = index;
  if (model == "telecentric")
    c.lens.magnification = 20;
  else
    c.lens.focal_length_mm = 25, c.lens.array_distance_mm = 87.5;
  return c;
}

TEST(ObjectMap, thick_lens_agrees_with_a_traced_particle) {
  // First particle of the ray-traced wall set; its z counts in the direction of the light, ours towards the lens.
  const ObjectMap map(lens("thick_lens", 1));
  const Point3 object = map.to_object({-3.45903, 7.90376, -20.68348});
  EXPECT_NEAR(object[0], 1.03958, 1e-5);
  EXPECT_NEAR(object[1], -2.37540, 1e-5);
  EXPECT_NEAR(object[2], 2.48649, 1e-5);
}

TEST(ObjectMap, thick_lens_images_are_inverted_and_obey_the_lens_formula) {
  const ObjectMap map(lens("thick_lens", 1));
  for (const double s : {30.0, 35.0, 41.0}) {
    const double behind = 1 / (1 / 25.0 - 1 / s);  // eq. (8)
    const Point3 image = map.to_image({1.0, -0.5, 35.0 - s});
    EXPECT_NEAR(image[0], -behind / s * 1.0, 1e-12);
    EXPECT_NEAR(image[1], -behind / s * -0.5, 1e-12);
    EXPECT_NEAR(image[2], 87.5 - behind, 1e-11);
  }
}

TEST(ObjectMap, telecentric_depths_scale_with_the_index_over_the_square_of_the_magnification) {
  const ObjectMap map(lens("telecentric", 1.333));
  const Point3 object = map.to_object({2.0, -4.0, -40.0});
  EXPECT_NEAR(object[0], -0.1, 1e-12);
  EXPECT_NEAR(object[1], 0.2, 1e-12);
  EXPECT_NEAR(object[2], 1.333 * 40.0 / 400, 1e-12);
}

TEST(ObjectMap, there_and_back_is_where_one_started) {
  for (const auto& map : {ObjectMap(lens("thick_lens", 1.333)), ObjectMap(lens("telecentric", 1.333))})
    for (const double z : {-30.0, -1.0, 0.0, 12.0}) {
      const Point3 image{1.5, -3.0, z};
      const Point3 back = map.to_image(map.to_object(image));
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], image[k], 1e-9);
    }
}

TEST(ObjectMap, the_jacobian_is_the_derivative) {
  for (const auto& map : {ObjectMap(lens("thick_lens", 1.333)), ObjectMap(lens("telecentric", 1.333))})
    for (const double z : {-33.0, 0.0, 16.0}) {
      const Point3 image{4.0, -7.0, z};
      const Matrix3 jacobian = map.jacobian(image);
      for (std::size_t column = 0; column < 3; ++column) {
        Point3 low = image, high = image;
        low[column] -= 1e-4, high[column] += 1e-4;
        const Point3 a = map.to_object(low), b = map.to_object(high);
        for (std::size_t row = 0; row < 3; ++row)
          EXPECT_NEAR(jacobian[row][column], (b[row] - a[row]) / 2e-4, 1e-7) << row << ' ' << column;
      }
    }
}

TEST(ObjectMap, the_covariance_is_that_of_mapped_samples) {
  const ObjectMap map(lens("thick_lens", 1));
  const Point3 at{6.0, -4.0, -20.0};
  const Covariance image{4e-4, 1e-4, 1e-3, 9e-4, -2e-3, 4e-2};
  // Cholesky factor, by hand, to draw samples with.
  const double l00 = std::sqrt(image[0]), l10 = image[1] / l00, l20 = image[2] / l00;
  const double l11 = std::sqrt(image[3] - l10 * l10), l21 = (image[4] - l20 * l10) / l11;
  const double l22 = std::sqrt(image[5] - l20 * l20 - l21 * l21);
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  const Point3 centre = map.to_object(at);
  Covariance sampled{};
  constexpr int kSamples = 200000;
  for (int i = 0; i < kSamples; ++i) {
    const double a = normal(random), b = normal(random), c = normal(random);
    const Point3 p = map.to_object({at[0] + l00 * a, at[1] + l10 * a + l11 * b, at[2] + l20 * a + l21 * b + l22 * c});
    const double dx = p[0] - centre[0], dy = p[1] - centre[1], dz = p[2] - centre[2];
    const Covariance product{dx * dx, dx * dy, dx * dz, dy * dy, dy * dz, dz * dz};
    for (std::size_t k = 0; k < 6; ++k) sampled[k] += product[k] / kSamples;
  }
  const Covariance mapped = map.to_object(image, map.jacobian(at));
  for (std::size_t k = 0; k < 6; ++k) EXPECT_NEAR(mapped[k], sampled[k], 0.02 * std::abs(sampled[k]) + 1e-6) << k;
}

TEST(ObjectMap, refuses_a_lens_that_forms_no_image) {
  auto calibration = lens("thick_lens", 1);
  calibration.lens.array_distance_mm = 20;
  EXPECT_THROW(ObjectMap{calibration}, Error);
  EXPECT_DOUBLE_EQ(ObjectMap(lens("thick_lens", 1)).highest_z_mm(), 62.5);
}

}  // namespace
}  // namespace rptv
