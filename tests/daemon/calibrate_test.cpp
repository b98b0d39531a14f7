// SPDX-License-Identifier: MIT
// The real binary calibrates a simulated camera from its own images, reconstructs with that, and refuses what is unfit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "calibration/light_field/object_map.hpp"
#include "core/error.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/daemon/small_run.hpp"

namespace rptv::testing {
namespace {

using ::testing::HasSubstr;

void expect_refusal(const Said& said, ExitCode code, const std::string& words) {
  EXPECT_EQ(said.code, static_cast<int>(code)) << said.err;
  EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  EXPECT_THAT(said.err, HasSubstr(words));
  EXPECT_EQ(said.out, "");
}

class Calibrate : public ::testing::Test {
 protected:
  std::string path(const char* name) const { return (run_.folder() / name).string(); }
  LightFieldCalibration truth() const { return read_light_field_calibration(path("calibration.toml")); }
  SmallRun run_{2};
};

TEST_F(Calibrate, lenslets_from_a_white_image_gives_a_camera_that_reconstructs) {
  const Said said = run_rapidptv({"calibrate", "lenslets", path("white.png"), "--start", path("calibration.toml"),
                                  "--dark", path("background.png"), "--fit-exit-pupil", "-o", path("cal.toml")});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("exit pupil"));
  const auto found = read_light_field_calibration(path("cal.toml"));
  EXPECT_NEAR(found.lens.exit_pupil_mm, truth().lens.exit_pupil_mm, 0.02 * truth().lens.exit_pupil_mm);
  EXPECT_NEAR(found.lenslets.offset_um[0], truth().lenslets.offset_um[0], 0.5);
  EXPECT_NEAR(found.lenslets.offset_um[1], truth().lenslets.offset_um[1], 0.5);
  for (const char* figure : {"cal_centres.png", "cal_residuals.png", "cal.h5"})
    EXPECT_GT(std::filesystem::file_size(path(figure)), 1000U) << figure;
  const auto points = [&](const char* calibration) {
    return run_rapidptv(
        {"reconstruct", path("frames"), "--config", path("rig.toml"), "--calibration", path(calibration)});
  };
  const Said mine = points("cal.toml"), given = points("calibration.toml");
  ASSERT_EQ(mine.code, 0) << mine.err;
  const auto rows = [](const Said& s) { return std::count(s.out.begin(), s.out.end(), '\n'); };
  EXPECT_GT(rows(given), 10);
  EXPECT_NEAR(static_cast<double>(rows(mine)), static_cast<double>(rows(given)), 2);
}

TEST_F(Calibrate, lenslets_says_why_not) {
  const auto lenslets = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"calibrate", "lenslets", "-o", path("none.toml")};
    words.insert(words.end(), more.begin(), more.end());
    return run_rapidptv(words);
  };
  const std::string start = path("calibration.toml"), white = path("white.png");
  expect_refusal(lenslets({path("background.png"), "--start", start}), ExitCode::bad_data, "background.png");
  expect_refusal(lenslets({white, "--start", start, "--pitch-um", "250"}), ExitCode::bad_data, "130.5");
  expect_refusal(lenslets({white, "--pixel-um", "9"}), ExitCode::usage, "--pitch-um");
  expect_refusal(lenslets({white, "--start", path("nowhere.toml")}), ExitCode::no_input, "nowhere.toml");
  expect_refusal(lenslets({path("nowhere.png"), "--start", start}), ExitCode::no_input, "nowhere.png");
  expect_refusal(lenslets({white, "--start", start, "--set", "sensor.width_px=300"}), ExitCode::configuration, "300x");
  EXPECT_FALSE(std::filesystem::exists(path("none.toml")));
}

TEST_F(Calibrate, volume_corrects_the_lens_by_known_points) {
  const ObjectMap lens(truth());
  std::ofstream table(path("pairs.csv"));
  table << "image_x,image_y,image_z,object_x,object_y,object_z\n";
  for (double x : {-3.0, -1.0, 1.0, 3.0})
    for (double y : {-3.0, -1.0, 1.0, 3.0})
      for (double z : {-3.0, 0.0, 3.0}) {
        const Point3 image = lens.to_image({x, y, z});
        table << image[0] << ',' << image[1] << ',' << image[2] << ',' << x * 1.01 << ',' << y << ',' << z + 0.1
              << '\n';
      }
  table.close();
  const Said said = run_rapidptv(
      {"calibrate", "volume", path("pairs.csv"), "--calibration", path("calibration.toml"), "-o", path("volume.toml")});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("points            48"));
  const Point3 at = ObjectMap(read_light_field_calibration(path("volume.toml"))).to_object(lens.to_image({2, 1, -1}));
  EXPECT_NEAR(at[0], 2.02, 1e-3);
  EXPECT_NEAR(at[1], 1, 1e-3);
  EXPECT_NEAR(at[2], -0.9, 1e-3);
  std::ofstream(path("few.csv")) << "image_x,image_y,image_z,object_x,object_y,object_z\n1,2,3,4,5,6\n";
  expect_refusal(run_rapidptv({"calibrate", "volume", path("few.csv"), "--calibration", path("calibration.toml"), "-o",
                               path("none.toml")}),
                 ExitCode::bad_data, "few.csv: has 1 points");
}

}  // namespace
}  // namespace rptv::testing
