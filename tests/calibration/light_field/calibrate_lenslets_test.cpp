// SPDX-License-Identifier: MIT
// From images to a calibration: exit pupil or pitch, distortion of the true lattice, masks, dark level, refusals.
#include "calibration/light_field/calibrate_lenslets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/light_field/calibration_figures.hpp"
#include "calibration/light_field/lenslet_lattice.hpp"
#include "calibration/light_field/lenslet_report.hpp"
#include "core/error.hpp"
#include "tests/calibration/light_field/white_image.hpp"

namespace rptv {
namespace {

using namespace testing;
using ::testing::HasSubstr;

void add(ImageStatistics& statistics, const GreyImage& image) {
  const std::vector<std::uint16_t> pixels(image.grey.begin(), image.grey.end());
  statistics.add({reinterpret_cast<const std::byte*>(pixels.data()),
                  {static_cast<std::uint32_t>(image.width), static_cast<std::uint32_t>(image.height), 2}},
                 "white.png");
}

LensletImages images_of(const WhiteScene& scene) {
  LensletImages images;
  images.origin = "white.png";
  add(images.images, draw_white(scene));
  return images;
}

WhiteScene scene_of(double exit_pupil_mm) {
  WhiteScene scene;
  scene.camera = white_camera();
  scene.camera.lens.exit_pupil_mm = exit_pupil_mm;
  return scene;
}

std::string refusal_of(const LensletImages& images, const LightFieldCalibration& sheet, bool known) {
  try {
    calibrate_lenslets(images, sheet, {known});
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_data);
    return error.what();
  }
  return "taken";
}

TEST(CalibrateLenslets, finds_the_exit_pupil_from_the_pitch) {
  const auto scene = scene_of(84.82);
  const auto result = calibrate_lenslets(images_of(scene), sheet_of(scene.camera), {});
  EXPECT_NEAR(result.calibration.lens.exit_pupil_mm, 84.82, 0.3);
  EXPECT_EQ(result.calibration.lenslets.pitch_um, 125.0);
  EXPECT_NEAR(result.calibration.lenslets.rotation_deg, 0.7, 0.002);
  EXPECT_NEAR(result.calibration.lenslets.offset_um[0], -22.2, 0.1);
  EXPECT_NEAR(result.calibration.lenslets.offset_um[1], 28.7, 0.1);
  EXPECT_THAT(to_text(result), HasSubstr("exit pupil        84."));
}

TEST(CalibrateLenslets, or_the_pitch_from_the_exit_pupil) {
  auto scene = scene_of(84.82);
  scene.camera.lenslets.pitch_um = 126.5;  // not what the data sheet says
  auto sheet = sheet_of(scene.camera);
  sheet.lens.exit_pupil_mm = 84.82, sheet.lenslets.pitch_um = 125;
  const auto result = calibrate_lenslets(images_of(scene), sheet, {true});
  EXPECT_NEAR(result.calibration.lenslets.pitch_um, 126.5, 0.02);
  EXPECT_EQ(result.calibration.lens.exit_pupil_mm, 84.82);
  EXPECT_THAT(to_text(result), HasSubstr("(+1.199 %): 33.1 lenslets designed across the sensor, 32.7 seen"));
}

TEST(CalibrateLenslets, tells_a_telecentric_lens_and_refuses_an_impossible_pitch) {
  const auto scene = scene_of(0);
  auto sheet = sheet_of(scene.camera);
  EXPECT_EQ(calibrate_lenslets(images_of(scene), sheet, {}).calibration.lens.exit_pupil_mm, 0);
  sheet.lenslets.pitch_um = 127;
  EXPECT_THAT(refusal_of(images_of(scene), sheet, false), HasSubstr("no exit pupil does that"));
  sheet.lenslets.pitch_um = 133;
  EXPECT_THAT(refusal_of(images_of(scene), sheet, true), HasSubstr("data sheet says 133"));
}

TEST(CalibrateLenslets, gives_the_true_lattice_the_distortion_that_the_spots_show) {
  auto scene = scene_of(40);
  scene.camera.lenslets.distortion_x_um = {0, 0, 5, 0, -4, -30, 0, -30, 0};
  scene.camera.lenslets.distortion_y_um = {0, 0, 0, 7, 0, 0, -30, 0, -30};
  auto sheet = sheet_of(scene.camera);
  sheet.lens.exit_pupil_mm = 40;
  const auto result = calibrate_lenslets(images_of(scene), sheet, {true});
  const LensletLattice truth(scene.camera), found(result.calibration);
  ASSERT_EQ(truth.size(), found.size());
  for (std::uint32_t k = 0; k < truth.size(); ++k) {
    const auto a = truth.spot_mm(k), b = found.spot_mm(k);
    ASSERT_LT(std::hypot(a[0] - b[0], a[1] - b[1]), 9e-4) << k;  // a tenth of a pixel, border and all
  }
}

TEST(CalibrateLenslets, knows_dark_level_noise_and_vignetting) {
  auto scene = scene_of(84.82);
  scene.clip_from_px = 150;
  auto images = images_of(scene);
  WhiteScene night = scene;
  night.grey = 0, night.read_noise = 2;
  for (unsigned k = 0; k < 20; ++k) {
    night.seed = 100 + k;
    GreyImage dark = draw_white(night);
    dark.at(7, 5) = 90;  // a hot pixel
    add(images.dark, dark);
  }
  const auto arrays = calibrate_lenslets(images, sheet_of(scene.camera), {}).arrays;
  ASSERT_EQ(arrays.dark_level.size(), 480U * 360U);
  EXPECT_EQ(arrays.dark_level[5 * 480 + 7], 90);
  EXPECT_NEAR(arrays.dark_level[5000], 0.8, 0.9);  // half of a normal distribution
  EXPECT_NEAR(arrays.dark_noise[5000], 1.2, 0.7);
  const auto light = [&](std::int64_t u, std::int64_t v) {
    return arrays
        .vignetting[static_cast<std::size_t>((v - arrays.fit.first_v) * arrays.fit.columns + u - arrays.fit.first_u)];
  };
  EXPECT_NEAR(light(0, 0), 1, 0.1);
  EXPECT_LT(light(13, 9), 0.85);
  EXPECT_NE(arrays.fit.of(13, 9), 0);
  EXPECT_EQ(arrays.ray.of(13, 9), 0);  // it has light, and its centre is known: it gives rays
}

TEST(CalibrateLenslets, masks_a_lenslet_without_light) {
  auto scene = scene_of(84.82);
  GreyImage image = draw_white(scene);
  const auto clean = calibrate_lenslets(images_of(scene), sheet_of(scene.camera), {}).found;
  const auto& dead = clean.spots[clean.spots.size() / 2];
  const int x = static_cast<int>(std::lround(dead.x_px)), y = static_cast<int>(std::lround(dead.y_px));
  for (int j = y - 7; j <= y + 7; ++j)
    for (int i = x - 7; i <= x + 7; ++i) image.at(i, j) = 0;
  LensletImages images;
  images.origin = "white.png";
  add(images.images, image);
  const auto result = calibrate_lenslets(images, sheet_of(scene.camera), {});
  const LensletLattice lattice(result.calibration);
  std::size_t masked = 0;
  for (std::uint32_t k = 0; k < lattice.size(); ++k) masked += lattice.masked(k) != 0 ? 1 : 0;
  EXPECT_GE(masked, 1U);
  EXPECT_LE(masked, 4U);
  const SensorFrame frame(scene.camera);
  const auto mm = frame.to_mm({dead.x_px, dead.y_px});
  std::array<std::uint32_t, 1> one{};
  lattice.lenslets_of(mm[0], mm[1], one);
  EXPECT_EQ(one[0], LensletLattice::kNone);
}

TEST(CalibrateLenslets, refuses_a_saturated_image) {
  auto images = images_of(scene_of(84.82));
  images.significant_bits = 6;  // 60 to 63 is the plateau of a sub-image
  EXPECT_THAT(refusal_of(images, sheet_of(white_camera()), false), HasSubstr("is saturated"));
}

TEST(CalibrateLenslets, figures_are_as_large_as_the_image_and_mark_every_lenslet) {
  const auto scene = scene_of(84.82);
  const auto result = calibrate_lenslets(images_of(scene), sheet_of(scene.camera), {});
  const auto centres = draw_centres(draw_white(scene), result.found);
  const auto& s = result.found.spots[100];
  const auto pixel =
      centres.pixels[static_cast<std::size_t>(std::lround(s.predicted_y_px) * 480 + std::lround(s.predicted_x_px))];
  EXPECT_EQ(pixel, (Colour{0, 220, 60}));
  const double enlargement = residual_enlargement(result.found, 14);
  EXPECT_GT(enlargement, 10);
  EXPECT_EQ(draw_residuals(draw_white(scene), result.found, enlargement).pixels.size(), centres.pixels.size());
  EXPECT_THAT(to_json(result), HasSubstr("\"exit_pupil_mm\":84."));
}

}  // namespace
}  // namespace rptv
