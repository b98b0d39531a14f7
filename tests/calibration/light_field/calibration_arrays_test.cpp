// SPDX-License-Identifier: MIT
// Calibration arrays through HDF5 and back; files that are none.
#include "calibration/light_field/calibration_arrays.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calibration/light_field/light_field_calibration.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class CalibrationArraysTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "rapidptv-arrays-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path folder_;
};

CalibrationArrays sample() {
  CalibrationArrays arrays;
  arrays.fit = {-3, -2, 3, 2, {0, 1, 2, 3, 4, 16}};
  arrays.ray = {-3, -2, 3, 2, {0, 0, 8, 0, 4, 0}};
  arrays.vignetting = {1.0F, 0.9F, 0.8F, 0.7F, 0.6F, 0.0F};
  arrays.area = {1.0F, 1.0F, 0.9F, 0.9F, 0.8F, 0.0F};
  arrays.width_px = 2, arrays.height_px = 3;
  arrays.dark_level = {1, 2, 3, 4, 5, 6}, arrays.dark_noise = {0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.25F};
  return arrays;
}

std::string refusal_of(const fs::path& file, ExitCode code) {
  try {
    read_calibration_arrays(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code);
    return error.what();
  }
  return "taken";
}

TEST_F(CalibrationArraysTest, come_back_as_they_were) {
  const auto arrays = sample();
  write_calibration_arrays(arrays, folder_ / "cal.h5");
  const auto back = read_calibration_arrays(folder_ / "cal.h5");
  EXPECT_EQ(back.fit.reasons, arrays.fit.reasons);
  EXPECT_EQ(back.ray.reasons, arrays.ray.reasons);
  EXPECT_EQ(back.fit.first_u, -3);
  EXPECT_EQ(back.ray.first_v, -2);
  EXPECT_EQ(back.fit.columns, 3);
  EXPECT_EQ(back.vignetting, arrays.vignetting);
  EXPECT_EQ(back.area, arrays.area);
  EXPECT_EQ(back.dark_level, arrays.dark_level);
  EXPECT_EQ(back.dark_noise, arrays.dark_noise);
  EXPECT_EQ(back.width_px, 2U);
  const auto& mask = back.ray;
  EXPECT_EQ(mask.of(-1, -2), 8);
  EXPECT_EQ(mask.of(-2, -1), 4);
  EXPECT_EQ(mask.of(0, 0), 0);
  EXPECT_EQ(mask.of(-100, 5), 0);
}

TEST_F(CalibrationArraysTest, a_calibration_file_brings_them) {
  auto arrays = sample();
  write_calibration_arrays(arrays, folder_ / "cal.h5");
  LightFieldCalibration c;
  c.sensor = {2, 3, 9.0, {}};
  c.lenslets.pitch_um = 125, c.lenslets.focal_length_mm = 3.75, c.lenslets.arrays = "cal.h5";
  c.lenslets.shape = "hexagonal", c.lenslets.distortion_x_um = {0, 0, 1e-3, 2e-3, 3e-3, 4e-3, 5e-3, 6e-3, 7e-3};
  c.lens.model = "telecentric", c.lens.magnification = 20;
  write_light_field_calibration(c, folder_ / "cal.toml");
  const auto back = read_light_field_calibration(folder_ / "cal.toml");
  EXPECT_EQ(back.arrays.ray.of(-2, -1), 4);
  EXPECT_EQ(back.arrays.dark_noise, arrays.dark_noise);
  EXPECT_EQ(back.lenslets.shape, "hexagonal");
  EXPECT_EQ(back.lenslets.distortion_x_um, c.lenslets.distortion_x_um);
  arrays.dark_noise[2] = std::nanf("");
  write_calibration_arrays(arrays, folder_ / "cal.h5");
  EXPECT_THAT(refusal_of(folder_ / "cal.h5", ExitCode::bad_data), HasSubstr("'dark_noise' has the value nan"));
  arrays = sample(), arrays.width_px = 3, arrays.height_px = 2;
  write_calibration_arrays(arrays, folder_ / "cal.h5");
  try {
    read_light_field_calibration(folder_ / "cal.toml");
    ADD_FAILURE() << "taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("'dark_level' has 3x2 px and the sensor of"));
  }
  fs::remove(folder_ / "cal.h5");
  EXPECT_THROW(read_light_field_calibration(folder_ / "cal.toml"), Error);
}

TEST_F(CalibrationArraysTest, refuse_what_is_no_such_file) {
  EXPECT_THAT(refusal_of(folder_ / "none.h5", ExitCode::no_input), HasSubstr("does not exist"));
  std::ofstream(folder_ / "text.h5") << "no HDF5";
  EXPECT_THAT(refusal_of(folder_ / "text.h5", ExitCode::bad_data), HasSubstr("not an HDF5 file"));
  write_calibration_arrays(sample(), folder_ / "cut.h5");
  fs::resize_file(folder_ / "cut.h5", fs::file_size(folder_ / "cut.h5") / 2);
  EXPECT_THAT(refusal_of(folder_ / "cut.h5", ExitCode::bad_data), HasSubstr("cut.h5"));
  EXPECT_THROW(write_calibration_arrays(sample(), folder_ / "nowhere" / "cal.h5"), Error);
}

}  // namespace
}  // namespace rptv
