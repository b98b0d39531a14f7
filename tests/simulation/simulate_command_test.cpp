// SPDX-License-Identifier: MIT
// The commands as a user gives them: installed lenses and scenarios by name, descriptions, and refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "calibration/cameras/rig.hpp"
#include "replay/image_file.hpp"
#include "simulation/challenge_rig.hpp"
#include "simulation/lpt_points.hpp"
#include "simulation/truth.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

using rptv::testing::run_rapidptv;
using rptv::testing::Said;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(SimulateCommand, names_installed_scenarios_and_lenses) {
  const Said scenarios = run_rapidptv({"simulate", "--list"});
  EXPECT_EQ(scenarios.code, 0);
  EXPECT_EQ(scenarios.out, "layers\nlpt_challenge\nmacro_wall\nmicrochannel\n");
  const Said lenses = run_rapidptv({"info", "--lenses"});
  EXPECT_EQ(lenses.code, 0);
  EXPECT_THAT(lenses.out, AllOf(HasSubstr("US 2,673,491"), HasSubstr("US 10,571,651"), HasSubstr("EFL 50.3582 mm")));
}

TEST(SimulateCommand, describes_every_installed_scenario) {
  for (const auto* name : {"layers", "macro_wall", "microchannel"}) {
    const Said said = run_rapidptv({"simulate", "--scenario", name, "--describe"});
    EXPECT_EQ(said.code, 0) << said.err;
    EXPECT_THAT(said.out, HasSubstr("pitches wide"));
  }
}

TEST(SimulateCommand, a_rig_is_described_as_the_file_that_calibrations_use) {
  const Said said = run_rapidptv({"simulate", "--scenario", "lpt_challenge", "--describe"});
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, AllOf(HasSubstr("[camera_4]"), HasSubstr("width_px = 960")));
}

TEST(SimulateCommand, a_rigs_run_has_images_of_every_camera_and_the_truth_in_both_forms) {
  const Place place;
  const std::string folder = place.file("lpt").string();
  const Said said = run_rapidptv({"simulate", "--scenario", "lpt_challenge", "--set", "views.sensor_part=0.1", "--set",
                                  "frames=2", "-o", folder, "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("\"frames\":2"));
  const Said checked = run_rapidptv({"check", "--config", folder + "/rig.toml"});
  EXPECT_EQ(checked.code, 0) << checked.out << checked.err;
  const Rig rig = read_rig(folder + "/cameras.toml");
  ASSERT_EQ(rig.cameras.size(), 4U);
  for (const char* image : {"cam0/frame_00000.png", "cam3/frame_00001.png"})
    EXPECT_EQ(open_image(folder + "/frames/" + image)->header(0).shape.width_px, 192U);
  const auto points = read_lpt_points(folder + "/truth/points_00001.txt");
  EXPECT_NEAR(static_cast<double>(points.size()), 0.05 * 192 * 120, 150);
  ASSERT_EQ(points.front().pixels.size(), 4U);
  const auto seen = rig.cameras[2].model.project(points.front().position_mm);
  EXPECT_EQ(points.front().pixels[2], *seen);
  std::size_t rows = 0, in_view = 0;
  for (const TruthRow& row : read_truth(folder + "/truth.csv")) rows += row.frame == 1, in_view += row.in_view;
  EXPECT_EQ(rows, points.size());
  EXPECT_GT(in_view, rows / 2);
  EXPECT_LT(in_view, 2 * rows) << "the box is as deep as ever: its corners are off a tenth of the sensor";
}

TEST(SimulateCommand, a_rigs_run_comes_again_from_its_own_folder) {
  const Place place;
  const std::string first = place.file("first").string(), second = place.file("second").string();
  write_rig(challenge_rig(0.05), place.file("rig.toml"));
  const Said said = run_rapidptv({"simulate", "--set", "views.rig=" + place.file("rig.toml").string(), "--set",
                                  "flow.kind=random", "--set", "frames=1", "--set", "camera.bits=10", "-o", first});
  ASSERT_EQ(said.code, 0) << said.err;
  std::filesystem::remove(place.file("rig.toml"));
  const Said again = run_rapidptv({"simulate", "--scenario", first + "/scenario.toml", "--threads", "1", "-o", second});
  ASSERT_EQ(again.code, 0) << again.err;
  const auto bytes = [](const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  for (const char* file : {"/frames/cam3/frame_00000.png", "/truth.csv", "/truth/points_00000.txt", "/rig.toml"}) {
    EXPECT_GT(bytes(first + file).size(), 100U) << file;
    EXPECT_EQ(bytes(first + file), bytes(second + file)) << file;
  }
}

TEST(SimulateCommand, refuses_a_name_that_is_not_there_and_lists_those_that_are) {
  const Said scenario = run_rapidptv({"simulate", "--scenario", "layer", "--describe"});
  EXPECT_EQ(scenario.code, 66);
  EXPECT_THAT(scenario.err, AllOf(HasSubstr("'layer'"), HasSubstr("layers, lpt_challenge, macro_wall, microchannel")));
  const Said lens = run_rapidptv({"simulate", "--describe", "--set", "main_lens.model=prescription", "--set",
                                  "main_lens.prescription=double_gaus_f2"});
  EXPECT_EQ(lens.code, 66);
  EXPECT_THAT(lens.err, HasSubstr("double_gauss_f2, macro_25mm_f28"));
}

TEST(SimulateCommand, refuses_a_prescription_with_its_line) {
  const auto file = std::filesystem::path(::testing::TempDir()) / ("lens_" + std::to_string(getpid()) + ".toml");
  std::ofstream(file) << "name = \"x\"\nsource = \"y\"\n[surfaces]\nradius_mm = [50, 0]\nthickness_mm = [4]\n"
                         "index_after = [1.5, 1]\nclear_diameter_mm = [20, 20]\nstop = 1\n";
  const Said said = run_rapidptv({"info", file});
  std::filesystem::remove(file);
  EXPECT_EQ(said.code, 78);
  EXPECT_THAT(said.err, HasSubstr(file.string() + ":5: surfaces.thickness_mm has 1 values"));
}

TEST(SimulateCommand, takes_positions_from_a_table) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / ("table_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "at.csv") << "frame,x,y,z\n0,0.5,0,1\n1,0.6,0,1\n1,-0.5,0.25,-1\n";
  std::ofstream(folder / "scenario.toml") << "frames = 2\n[flow]\nkind = \"table\"\ntable = \"at.csv\"\n"
                                             "[camera]\nwidth_px = 192\nheight_px = 160\n";
  const Said said =
      run_rapidptv({"simulate", "--scenario", folder / "scenario.toml", "--out", folder / "run", "--json"});
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("\"particles_per_frame\":1.5"));
  std::ifstream truth(folder / "run" / "truth.csv");
  std::string header, first;
  std::getline(truth, header);
  std::getline(truth, first);
  EXPECT_EQ(first.substr(0, 12), "0,0,0.5,0,1,");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace rptv
