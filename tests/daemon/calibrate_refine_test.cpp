// SPDX-License-Identifier: MIT
// The real binary puts a pushed camera right by images of particles, and says why when it cannot.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "core/error.hpp"
#include "tests/daemon/pushed_rig.hpp"
#include "tests/daemon/run_binary.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Said refine(const PushedRig& pushed, std::vector<std::string> more) {
  std::vector<std::string> words{"calibrate", "refine",
                                 "--start",   pushed.file("rig.toml"),
                                 "-o",        pushed.file("better.toml"),
                                 "--set",     "multi_view.volume_x_mm=[-100, 100]",
                                 "--set",     "multi_view.volume_y_mm=[-100, 100]",
                                 "--set",     "multi_view.volume_z_mm=[-100, 100]",
                                 "--parts",   "2",
                                 "2",         "2"};
  words.insert(words.end(), more.begin(), more.end());
  return run_rapidptv(words);
}

TEST(CalibrateRefine, puts_a_pushed_camera_right) {
  const PushedRig pushed;
  const Said said = refine(pushed, {pushed.frames(), "--search", "4"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("cam2         disparity "), HasSubstr("8 of 8 parts")));
  const Rig better = read_rig(pushed.file("better.toml"));
  for (std::size_t c = 0; c < 4; ++c)
    for (const Point3& at : {Point3{0, 0, 0}, Point3{60, -60, 60}, Point3{-60, 60, -60}}) {
      const Pixel seen = *better.cameras[c].model.project(at), truth = *pushed.rig.cameras[c].model.project(at);
      EXPECT_NEAR(seen[0], truth[0], 0.1) << c;
      EXPECT_NEAR(seen[1], truth[1], 0.1) << c;
    }
  const Said json = refine(pushed, {pushed.frames(), "--search", "4", "--rounds", "1", "--json"});
  EXPECT_THAT(json.out, AllOf(HasSubstr(R"({"instants":2,"parts":8,"cameras":[{"name":"cam0","before_px":)"),
                              HasSubstr(R"("turned_deg":)")));
}

TEST(CalibrateRefine, says_why_not) {
  const PushedRig pushed;
  const auto refused = [&](const std::vector<std::string>& words, ExitCode code, const std::string& part) {
    const Said said = refine(pushed, words);
    EXPECT_EQ(said.code, static_cast<int>(code)) << said.err;
    EXPECT_THAT(said.err, HasSubstr(part));
    EXPECT_EQ(said.out, "");
    EXPECT_FALSE(std::filesystem::exists(pushed.file("better.toml")));
  };
  refused({pushed.frames(), "--search", "1"}, ExitCode::bad_data, "search farther");
  refused({}, ExitCode::usage, "name the folder of all cameras");
  for (const char* gone : {"cam2", "cam3"})
    for (const char* instant : {"_0.png", "_1.png"}) std::filesystem::remove(pushed.frames() + "/" + gone + instant);
  refused({pushed.frames()}, ExitCode::bad_data, "has images of 2 cameras and particles tell of 3 or more");
}

}  // namespace
}  // namespace rptv::testing
