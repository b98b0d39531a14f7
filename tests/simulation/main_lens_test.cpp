// SPDX-License-Identifier: MIT
// The three lens models and the refracting lenslets: against first order, each other, and an independent trace.
#include "simulation/main_lens.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"
#include "simulation/camera_report.hpp"
#include "simulation/optics.hpp"

namespace rptv {
namespace {

const std::string kDoubleGauss = std::string(RPTV_SOURCE_DIR) + "/simulation/prescriptions/double_gauss_f2.toml";

ScenarioSettings traced_scene() {
  ScenarioSettings s;
  s.main_lens.model = "prescription";
  s.main_lens.prescription = kDoubleGauss;
  s.main_lens.magnification = 1;
  s.main_lens.stop_radius_mm = 1.063;
  return s;
}

ScenarioSettings microscope() {
  ScenarioSettings s;
  s.main_lens.model = "aplanat";
  s.main_lens.magnification = 20;
  s.seeding.volume_x_mm = 0.6;
  s.seeding.volume_y_mm = s.seeding.volume_z_mm = 0.2;
  return s;
}

TEST(PrescriptionLens, converges_on_the_paraxial_image_near_the_axis) {
  const LightFieldOptics optics(traced_scene());
  for (const double z : {-3.0, 0.0, 3.0}) {
    const Vector3 object{0.05, -0.1, z}, image = optics.image_of(object);
    const auto real = optics.convergence(object);
    ASSERT_TRUE(real);
    EXPECT_NEAR(real->x, image.x, 2e-4);
    EXPECT_NEAR(real->y, image.y, 2e-4);
    EXPECT_NEAR(real->z, image.z, 0.02);  // spherical aberration at f/31
  }
}

TEST(PrescriptionLens, hands_the_reconstruction_its_first_order) {
  const auto calibration = LightFieldOptics(traced_scene()).calibration();
  EXPECT_EQ(calibration.lens.model, "thick_lens");
  EXPECT_NEAR(calibration.lens.exit_pupil_mm, 104.23542893586806, 1e-9);
  EXPECT_NEAR(calibration.lens.focal_length_mm, 50.35816695831366, 1e-11);
  EXPECT_NEAR(calibration.lens.array_distance_mm, 100.71633391662732, 1e-10);
  EXPECT_NEAR(calibration.lens.image_f_number, 31.591594485912534, 1e-9);
}

TEST(PrescriptionLens, loses_light_at_rims_off_the_axis) {
  ScenarioSettings s = traced_scene();
  const auto light = [&](double x) {
    const auto lens = make_main_lens(s);
    const auto samples = std::vector<RaySample>(1, RaySample{});
    double sum = 0;
    std::vector<ArrayRay> ray(1);
    for (double px = -0.95; px < 1; px += 0.1) {
      const std::vector<RaySample> one{{static_cast<float>(px), 0, 0, 0}};
      lens->trace({x, 0, 0}, 0, one, 0, ray);
      sum += ray[0].weight > 0;
    }
    return sum;
  };
  const double open = light(9);
  s.main_lens.rim_z_mm = {-7, 39};
  s.main_lens.rim_radius_mm = {2.75, 3};
  EXPECT_LT(light(9), 0.8 * open);
  EXPECT_EQ(light(0), open);
}

TEST(PrescriptionLens, white_light_comes_out_of_the_exit_pupil) {
  const LightFieldOptics optics(traced_scene());
  std::vector<RaySample> centre(1);
  std::vector<ArrayRay> ray(1);
  optics.lens().white(3, -2, 0, centre, ray);
  ASSERT_GT(ray[0].weight, 0);
  EXPECT_NEAR(ray[0].slope_x, 3 / optics.exit_pupil_mm(), 2e-5);
  EXPECT_NEAR(ray[0].slope_y, -2 / optics.exit_pupil_mm(), 2e-5);
}

TEST(PrescriptionLens, refuses_what_forms_no_image) {
  const auto message = [](const ScenarioSettings& s) -> std::string {
    try {
      make_main_lens(s);
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  ScenarioSettings s = traced_scene();
  s.main_lens.magnification = 0;
  s.main_lens.focus_distance_mm = 35;
  EXPECT_THAT(message(s), testing::HasSubstr("within the focal length 50.358 mm"));
  s = traced_scene();
  s.main_lens.stop_radius_mm = 8.6;
  EXPECT_THAT(message(s), testing::HasSubstr("stop_radius_mm = 8.6 is wider than the stop of the lens (8.55 mm)"));
  s = traced_scene();
  s.main_lens.prescription = "double_gaus_f2";
  EXPECT_THAT(message(s), testing::HasSubstr("double_gauss_f2"));  // names what there is
  s.main_lens.prescription = "no/such/lens.toml";
  EXPECT_THAT(message(s), testing::HasSubstr("no/such/lens.toml"));
}

TEST(Aplanat, converges_as_an_independent_trace_of_the_same_objective) {  // data set lf-microchannel
  const LightFieldOptics optics(microscope());
  const auto at = [&](double z) { return optics.convergence({0.02, -0.03, z})->z; };
  EXPECT_NEAR((at(0.08) - at(-0.08)) / 0.16, -315.4950, 3e-4 * 315);
  EXPECT_NEAR(at(0), -1.4050, 0.01);
  const auto image = optics.convergence({0.02, -0.03, 0.05});
  EXPECT_NEAR(image->x, -0.4, 1e-4);
  EXPECT_NEAR(image->y, 0.6, 1e-4);
  EXPECT_NEAR(optics.image_of({0, 0, 0.1}).z, -400 * 0.1 / 1.333, 1e-9);  // eq. (11)
}

TEST(Aplanat, keeps_the_sine_condition) {
  const auto lens = make_main_lens(microscope());
  std::vector<ArrayRay> ray(1);
  const std::vector<RaySample> rim{{1, 0, 0, 0}};
  lens->trace({0, 0, 0}, 0, rim, 0, ray);
  const double sine = std::abs(ray[0].slope_x) / std::hypot(1, ray[0].slope_x);
  EXPECT_NEAR(sine, 0.5 / 20, 1e-12);
  const auto calibration = LightFieldOptics(microscope()).calibration();
  EXPECT_EQ(calibration.lens.model, "telecentric");
  EXPECT_NEAR(calibration.lens.image_f_number, 20, 0.01);
  EXPECT_NEAR(calibration.subimage_overlap(), 1.5004689698410663, 1e-9);
  EXPECT_NO_THROW(calibration.validate("microscope"));
}

TEST(LensletArray, refracting_lenslets_land_light_as_thin_ones_do) {
  LensletArraySettings settings;
  const LensletArray thin(settings);
  settings.model = "plano_convex";
  const LensletArray thick(settings);
  const auto land = [](const LensletArray& array, const ArrayRay& ray) {
    SensorMm at;
    array.land({&ray, 1}, Lenslet{5, -3}, {&at, 1});
    return at;
  };
  for (const double slope : {0.0, 0.02, 0.1}) {
    const auto centre = thin.centre({5, -3});
    const ArrayRay through_vertex{centre[0], centre[1], slope, -0.5 * slope, 1};
    const auto ideal = land(thin, through_vertex), real = land(thick, through_vertex);
    EXPECT_NEAR(real[0], ideal[0], 3e-5 + 0.2 * std::pow(slope, 3));
    const ArrayRay beside{centre[0] + 0.05, centre[1] - 0.04, slope, 0, 1};
    const auto bent = land(thick, beside);
    EXPECT_NEAR(bent[0], centre[0] + 3.75 * slope, 1e-4 + 0.1 * slope * slope);  // the place hardly matters
  }
}

TEST(Camera, is_described_for_people) {
  EXPECT_THAT(describe_camera(traced_scene()), testing::HasSubstr("exit pupil 104.2354 mm before the array"));
  EXPECT_THAT(describe_camera(microscope()), testing::HasSubstr("sub-images 1.50 pitches wide"));
}

TEST(Camera, counts_particles_by_the_lenslets_that_see_them) {
  ScenarioSettings s;
  s.seeding.per_lenslet = 0.1;  // a 7 mm box at 2.5:1 covers 140 x 140 lenslets
  EXPECT_EQ(LightFieldOptics(s).particles_in_box(), 1960);
}

}  // namespace
}  // namespace rptv
