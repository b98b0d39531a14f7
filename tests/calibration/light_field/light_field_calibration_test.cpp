// SPDX-License-Identifier: MIT
// Calibration files: what is read, what is derived, and how damaged ones are refused.
#include "calibration/light_field/light_field_calibration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

const std::string kGood =
    "schema = 1\n[sensor]\nwidth_px = 200\nheight_px = 100\npixel_um = 5.0\n"
    "[lenslets]\npitch_um = 125.0\nfocal_length_mm = 3.75\n"
    "[lens]\nmodel = \"thick_lens\"\nexit_pupil_mm = 100.0\nfocal_length_mm = 50.0\narray_distance_mm = 100.0\n";

std::string with(const std::string& line, const std::string& replacement) {
  std::string text = kGood;
  const auto at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size(), replacement);
}

std::string refusal_of(const std::string& text) {
  try {
    parse_light_field_calibration(text, "cal.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    EXPECT_THAT(error.what(), ::testing::StartsWith("cal.toml"));
    EXPECT_THAT(error.what(), ::testing::Not(HasSubstr("\n")));
    return error.what();
  }
  return "taken";
}

TEST(LightFieldCalibration, reads_the_examples_and_derives_their_truth) {
  const std::string folder = RPTV_SOURCE_DIR "/tests/reconstruct/data/";
  const auto macro = read_light_field_calibration(folder + "lf_macro_calibration.toml");
  EXPECT_NEAR(macro.pitch_mm() * macro.apparent_scale(), 0.12949703142957664, 1e-9);
  EXPECT_NEAR(macro.magnification(), 1.0, 1e-9);
  EXPECT_NEAR(macro.subimage_overlap(), 3.75 / 31.59 / 0.1295, 1e-3);
  EXPECT_TRUE(macro.warnings().empty());
  const auto wall = read_light_field_calibration(folder + "lf_wall_calibration.toml");
  EXPECT_NEAR(wall.magnification(), 2.5, 1e-12);
  EXPECT_NEAR(wall.pitch_mm() * wall.apparent_scale(), 0.13052631578947368, 1e-12);
  EXPECT_EQ(wall.optical_axis_px(), (std::array<double, 2>{1023.5, 767.5}));
}

TEST(LightFieldCalibration, a_telecentric_lens_has_one_lattice_and_warns_of_overlap) {
  const auto microscope =
      read_light_field_calibration(RPTV_SOURCE_DIR "/tests/reconstruct/data/lf_microchannel_calibration.toml");
  EXPECT_EQ(microscope.apparent_scale(), 1.0);
  EXPECT_EQ(microscope.magnification(), 20.0);
  ASSERT_EQ(microscope.warnings().size(), 1U);
  EXPECT_THAT(microscope.warnings()[0], HasSubstr("1.5 pitches"));
}

TEST(LightFieldCalibration, refuses_numbers_that_are_none_with_line_and_key) {
  EXPECT_THAT(refusal_of(with("pitch_um = 125.0", "pitch_um = 0.0")), HasSubstr("cal.toml:7"));
  EXPECT_THAT(refusal_of(with("pitch_um = 125.0", "pitch_um = 0.0")), HasSubstr("lenslets.pitch_um"));
  EXPECT_THAT(refusal_of(with("pitch_um = 125.0", "pitch_um = nan")), HasSubstr("cal.toml:7"));
  EXPECT_THAT(refusal_of(with("pitch_um = 125.0", "pitch_um = -125.0")), HasSubstr("cal.toml:7"));
  EXPECT_THAT(refusal_of(with("exit_pupil_mm = 100.0", "exit_pupil_mm = inf")), HasSubstr("cal.toml:11"));
  EXPECT_THAT(refusal_of(with("width_px = 200", "width_px = 0")), HasSubstr("cal.toml:3"));
}

TEST(LightFieldCalibration, refuses_what_is_missing_unknown_or_newer) {
  EXPECT_THAT(refusal_of(with("pixel_um = 5.0\n", "")), HasSubstr("pixel_um"));
  EXPECT_THAT(refusal_of(with("pitch_um", "pitch_mum")), HasSubstr("pitch_um"));
  EXPECT_THAT(refusal_of(with("schema = 1", "schema = 99")), HasSubstr("99"));
  EXPECT_THAT(refusal_of(with("thick_lens", "fisheye")), HasSubstr("fisheye"));
}

TEST(LightFieldCalibration, refuses_contradictions) {
  EXPECT_THAT(refusal_of(with("array_distance_mm = 100.0", "array_distance_mm = 40.0")),
              HasSubstr("array_distance_mm"));
  EXPECT_THAT(refusal_of(kGood + "magnification = 2.0\n"), HasSubstr("magnification"));
  EXPECT_THAT(refusal_of(with("thick_lens", "telecentric")), HasSubstr("magnification"));
  EXPECT_THAT(refusal_of(with("pitch_um = 125.0", "pitch_um = 8.0")), HasSubstr("two pixels"));
  EXPECT_THAT(refusal_of(with("pixel_um = 5.0", "pixel_um = 5.0\noptical_axis_px = [1.0]")),
              HasSubstr("optical_axis_px"));
}

TEST(LightFieldCalibration, a_missing_file_is_no_input) {
  try {
    read_light_field_calibration("nowhere/cal.toml");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::no_input);
    EXPECT_THAT(error.what(), HasSubstr("nowhere/cal.toml"));
  }
}

}  // namespace
}  // namespace rptv
