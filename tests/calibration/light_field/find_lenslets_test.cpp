// SPDX-License-Identifier: MIT
// Lattices found in drawn white images, against the lattices that they were drawn from; and images that have none.
#include "calibration/light_field/find_lenslets.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "core/error.hpp"
#include "tests/calibration/light_field/white_image.hpp"

namespace rptv {
namespace {

using namespace testing;
using ::testing::HasSubstr;

FoundLenslets find(const WhiteScene& scene, FindOptions options = {}) {
  options.origin = "white.png";
  return find_lenslets(draw_white(scene), sheet_of(scene.camera), options);
}

std::string refusal_of(const GreyImage& image, const LightFieldCalibration& sheet, FindOptions options = {}) {
  options.origin = "white.png";
  try {
    find_lenslets(image, sheet, options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_data);
    EXPECT_THAT(error.what(), HasSubstr("white.png: "));
    return error.what();
  }
  return "taken";
}

TEST(FindLenslets, finds_every_lattice_whatever_its_pitch_rotation_and_offset) {
  const bool held = rc::check([] {
    WhiteScene scene;
    auto& lenslets = scene.camera.lenslets;
    scene.camera = white_camera(360, 300);
    lenslets.shape = *rc::gen::inRange(0, 2) == 0 ? "square" : "hexagonal";
    const int turn = lenslets.shape == "square" ? 440 : 290;  // a lattice looks the same after 90 or 60 degrees
    lenslets.rotation_deg = *rc::gen::inRange(-turn, turn) * 0.1;
    lenslets.offset_um = {*rc::gen::inRange(-60, 60) * 1.0, *rc::gen::inRange(-60, 60) * 1.0};
    scene.camera.lens.exit_pupil_mm = *rc::gen::inRange(20, 400) * 1.0;
    scene.camera.sensor.pixel_um = *rc::gen::inRange(50, 110) * 0.1;
    scene.radius_pitches = *rc::gen::inRange(15, 47) * 0.01;
    const auto found = find(scene);
    RC_ASSERT(spot_errors_px(found, scene.camera).back() < 0.05);
    RC_ASSERT(std::abs(found.fit.lattice.pitch_mm / scene.camera.pitch_mm() / scene.camera.apparent_scale() - 1) <
              2e-4);
  });
  EXPECT_TRUE(held);
}

TEST(FindLenslets, is_not_misled_by_a_lattice_nearly_commensurate_with_the_pixels) {
  WhiteScene scene;
  scene.camera = white_camera(360, 300);
  scene.camera.lenslets.rotation_deg = -40.4, scene.camera.lenslets.offset_um = {-60, -60};
  scene.camera.lens.exit_pupil_mm = 28, scene.camera.sensor.pixel_um = 5.4;
  for (const double radius : {0.15, 0.2, 0.45}) {
    scene.radius_pitches = radius;
    const auto found = find(scene);
    EXPECT_EQ(found.fit.parameters, 4U) << radius;  // a mean of the pixels nearest to each node showed a distortion
    EXPECT_LT(spot_errors_px(found, scene.camera).back(), 0.03) << radius;
  }
}

TEST(FindLenslets, fits_a_distortion_when_there_is_one_and_none_when_there_is_not) {
  WhiteScene scene;
  scene.camera = white_camera();
  EXPECT_EQ(find(scene).fit.parameters, 4U);
  scene.camera.lenslets.distortion_x_um = {0, 0, 5, 0, -4, -30, 0, -30, 0};
  scene.camera.lenslets.distortion_y_um = {0, 0, 0, 7, 0, 0, -30, 0, -30};
  const auto found = find(scene);
  EXPECT_EQ(found.fit.parameters, 20U);
  EXPECT_LT(spot_errors_px(found, scene.camera).back(), 0.05);  // 4 px at the corners without it
}

TEST(FindLenslets, leaves_cats_eyes_out_and_extrapolates_over_them) {
  WhiteScene scene;
  scene.camera = white_camera(960, 720);
  scene.clip_from_px = 260;
  const auto found = find(scene);
  std::size_t cut = 0, cut_and_fitted = 0;
  for (const auto& s : found.spots) {
    const double far = std::hypot(s.x_px - 479.5, s.y_px - 359.5);
    if (far < 330) continue;  // shifted by 1.4 px and more
    ++cut, cut_and_fitted += s.reason == 0 ? 1 : 0;
  }
  EXPECT_GT(cut, 1500U);
  EXPECT_LT(cut_and_fitted, cut / 50);
  EXPECT_LT(spot_errors_px(found, scene.camera).back(), 0.1);
}

TEST(FindLenslets, finds_centres_between_the_bright_places_of_overlapping_sub_images) {
  WhiteScene scene;
  scene.camera = white_camera();
  scene.radius_pitches = 0.75, scene.camera.lens.image_f_number = 3.75 / (1.5 * 0.125 * scene.camera.apparent_scale());
  const auto found = find(scene);
  EXPECT_TRUE(found.overlapping);
  EXPECT_LT(spot_errors_px(found, scene.camera).back(), 0.1);
  auto sheet = sheet_of(scene.camera);
  sheet.lens.image_f_number = 0;
  EXPECT_THAT(refusal_of(draw_white(scene), sheet), HasSubstr("--f-number"));
  sheet.lens.image_f_number = 3.75 / (1.22 * 0.125 * scene.camera.apparent_scale());
  EXPECT_THAT(refusal_of(draw_white(scene), sheet), HasSubstr("does not tell centres from borders"));
}

TEST(FindLenslets, leaves_out_a_lenslet_under_dust_and_one_that_sits_askew) {
  WhiteScene scene;
  scene.camera = white_camera();
  GreyImage image = draw_white(scene);
  const auto clean = find(scene);
  const auto& dusty = clean.spots[clean.spots.size() / 3];
  const auto& askew = clean.spots[2 * clean.spots.size() / 3];
  const auto place = [&](const FoundSpot& s, int shift, float factor) {
    const GreyImage before = image;
    const int x = static_cast<int>(s.x_px), y = static_cast<int>(s.y_px);
    for (int j = y - 6; j <= y + 6; ++j)
      for (int i = x - 6; i <= x + 6; ++i) image.at(i, j) = factor * before.at(i + shift, j);
  };
  place(dusty, 0, 0.3F), place(askew, 1, 1);
  const auto found = find_lenslets(image, sheet_of(scene.camera), {"white.png", false, 0, 0});
  std::size_t left_out = 0;
  std::uint8_t dusty_reason = 0, askew_reason = 0;
  for (const auto& s : found.spots) {
    left_out += s.reason != 0 ? 1 : 0;
    if (std::hypot(s.x_px - dusty.x_px, s.y_px - dusty.y_px) < 3) dusty_reason = s.reason;
    if (std::hypot(s.x_px - askew.x_px, s.y_px - askew.y_px) < 3) askew_reason = s.reason;
  }
  EXPECT_NE(dusty_reason & lenslet_reason::kBrightness, 0);
  EXPECT_NE(askew_reason & lenslet_reason::kResidual, 0);
  EXPECT_LE(left_out, 6U);
}

TEST(FindLenslets, refuses_images_that_show_nothing_or_something_else) {
  WhiteScene scene;
  scene.camera = white_camera();
  const GreyImage image = draw_white(scene);
  auto sheet = sheet_of(scene.camera);
  EXPECT_THAT(refusal_of(GreyImage(480, 360, 7), sheet), HasSubstr("is empty"));
  scene.grey = 0;
  EXPECT_THAT(refusal_of(draw_white(scene), sheet), HasSubstr("no square lattice"));
  sheet.lenslets.pitch_um = 250;
  EXPECT_THAT(refusal_of(image, sheet), HasSubstr("130.5 um"));
  sheet.lenslets.pitch_um = 62.5;
  EXPECT_THAT(refusal_of(image, sheet), HasSubstr("coarser"));
  sheet.lenslets.pitch_um = 30;
  EXPECT_THAT(refusal_of(image, sheet), HasSubstr("at least 4"));
  sheet.lenslets.pitch_um = 2000;
  EXPECT_THAT(refusal_of(image, sheet), HasSubstr("fewer than 8"));
  sheet.lenslets.pitch_um = 125, sheet.lenslets.shape = "hexagonal";
  EXPECT_THAT(refusal_of(image, sheet), HasSubstr("hexagonal"));
}

TEST(FindLenslets, refuses_moire_by_its_period) {
  GreyImage image(480, 360);
  std::mt19937 random(3);
  std::normal_distribution<float> noise(0, 3);
  for (int row = 0; row < 360; ++row)
    for (int column = 0; column < 480; ++column)
      image.at(column, row) =
          100 + 30 * (std::cos(0.17F * static_cast<float>(column)) + std::cos(0.17F * static_cast<float>(row))) +
          noise(random);
  EXPECT_THAT(refusal_of(image, sheet_of(white_camera())), HasSubstr("36.9"));
  EXPECT_THAT(refusal_of(image, sheet_of(white_camera())), HasSubstr("moire"));
}

TEST(FindLenslets, particle_images_show_the_lattice_by_which_pixels_are_never_lit) {
  WhiteScene scene;
  scene.camera = white_camera(960, 720);
  const GreyImage full = draw_white(scene);
  GreyImage lit(960, 720);
  std::mt19937 random(4);
  std::uniform_int_distribution<int> column(0, 959), row(0, 719);
  for (int patch = 0; patch < 2500; ++patch) {
    const int i0 = column(random), j0 = row(random);
    for (int j = j0; j < std::min(720, j0 + 9); ++j)
      for (int i = i0; i < std::min(960, i0 + 9); ++i) lit.at(i, j) = full.at(i, j) > 20 ? 1.0F : 0.0F;
  }
  const auto found = find_lenslets(lit, sheet_of(scene.camera), {"frames", true, 0, 0});
  EXPECT_LT(spot_errors_px(found, scene.camera).back(), 0.5);
  EXPECT_THAT(refusal_of(GreyImage(960, 720), sheet_of(scene.camera), {"", true, 0, 0}), HasSubstr("empty"));
}

}  // namespace
}  // namespace rptv
