// SPDX-License-Identifier: MIT
// OpenPTV's calibrations against what liboptv itself projects, and there and back.
#include "calibration/cameras/openptv.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <fstream>
#include <sstream>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "tests/calibration/cameras/sample_cameras.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

constexpr const char* kOri = "10.5 -20 600\n 0.01 0.02 -0.03\n\n 1 0 0\n 0 1 0\n 0 0 1\n\n 0.1 -0.2\n 70\n\n 0 0 125\n";
constexpr const char* kSetup =
    "2\nimg/a.\ncal/a.tif\nimg/b.\ncal/b.tif\n1\n0\n1\n1280\n1024\n0.012\n0.0125\n0\n1\n1.46\n1.33\n6\n";

std::string refusal(auto read) {
  try {
    read();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

/// A folder as OpenPTV has it: kSetup, cal/a with .addpar, cal/b without.
class Folder {
 public:
  Folder() {
    for (const char* name : {"parameters", "cal"}) std::filesystem::create_directory(place_.file(name));
    place_.write("parameters/ptv.par", kSetup);
    place_.write("cal/a.tif.ori", kOri);
    place_.write("cal/a.tif.addpar", "1e-4 0 0 0 0 1.01 0");
    place_.write("cal/b.tif.ori", kOri);
  }
  const Place& place() const { return place_; }

 private:
  Place place_;
};

TEST(Openptv, projects_as_liboptv_does) {
  std::ifstream table(RPTV_SOURCE_DIR "/tests/calibration/data/liboptv_projections.csv");
  int rows = 0;
  for (std::string line; std::getline(table, line);) {
    if (line.starts_with('#') || line.starts_with("scale,")) continue;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    std::string scale;
    fields >> scale;
    OpenptvCamera c;
    OpenptvSetup s;
    Point3 point;
    Pixel seen;
    for (double* value : {&c.position_mm[0], &c.position_mm[1], &c.position_mm[2], &c.angles_rad[0], &c.angles_rad[1],
                          &c.angles_rad[2], &c.xh_mm, &c.yh_mm, &c.cc_mm, &c.glass_mm[0], &c.glass_mm[1],
                          &c.glass_mm[2], &c.k1, &c.k2, &c.k3, &c.p1, &c.p2, &c.scale_x, &c.shear_rad})
      fields >> *value;
    fields >> s.width_px >> s.height_px;
    for (double* value : {&s.pixel_x_mm, &s.pixel_y_mm, &s.index_before, &s.index_glass, &s.index_behind, &s.glass_mm,
                          &point[0], &point[1], &point[2], &seen[0], &seen[1]})
      fields >> *value;
    ASSERT_TRUE(fields) << line;
    const auto model = from_openptv(c, s, scale == "both" ? OpenptvScale::both : OpenptvScale::columns, "row");
    const auto ours = model.project(point);
    ASSERT_TRUE(ours) << line;
    EXPECT_NEAR((*ours)[0], seen[0] - 0.5, 1e-6) << line;
    EXPECT_NEAR((*ours)[1], seen[1] - 0.5, 1e-6) << line;
    ++rows;
  }
  EXPECT_EQ(rows, 288);
}

TEST(Openptv, a_folder_is_found_by_its_setup_or_by_itself) {
  const Folder folder;
  const auto import = import_openptv(folder.place().file("parameters/ptv.par"));
  ASSERT_EQ(import.rig.cameras.size(), 2U);
  EXPECT_EQ(import.rig.cameras[0].name, "a");
  EXPECT_NE(import.rig.cameras[0].model.intrinsics().k1, 0);
  EXPECT_EQ(import.rig.cameras[1].model.intrinsics().k1, 0);
  EXPECT_EQ(import.rig.cameras[1].model.stack().interfaces.size(), 2U);
  EXPECT_EQ(to_toml(import_openptv(folder.place().file("")).rig), to_toml(import.rig));
  ASSERT_EQ(import.warnings.size(), 1U);
  EXPECT_NE(import.warnings[0].find("scx = 1.01"), std::string::npos) << import.warnings[0];
}

TEST(Openptv, warns_of_a_liquid_above_its_glass) {
  const Folder folder;
  std::string swapped = kSetup;
  swapped.replace(swapped.find("1.46\n1.33"), 9, "1.33\n1.46");
  folder.place().write("parameters/ptv.par", swapped);
  EXPECT_NE(import_openptv(folder.place().file("")).warnings.at(0).find("swapped?"), std::string::npos);
}

RC_GTEST_PROP(Openptv, an_exported_rig_comes_back, ()) {
  CameraIntrinsics lens = drawn_lens();
  lens.cx_px = 639.5, lens.cy_px = 511.5;
  CameraPose pose = drawn_pose();
  const Rig rig{{{"left", CameraModel(lens, pose, drawn_tank())}}};
  const Place place;
  RC_ASSERT(export_openptv(rig, 0.01, place.file("out"), "rig.toml").at(0) < 1e-7);
  const Rig back = import_openptv(place.file("out")).rig;
  for (int i = 0; i < 10; ++i) {
    const Point3 point = drawn_point();
    const auto before = rig.cameras[0].model.project(point), after = back.cameras[0].model.project(point);
    RC_ASSERT(before.has_value() == after.has_value());
    if (before) RC_ASSERT(std::hypot((*before)[0] - (*after)[0], (*before)[1] - (*after)[1]) < 1e-7);
  }
}

TEST(Openptv, a_surface_without_glass_comes_back) {
  const CameraModel model({1280, 1024, 5800, 5800, 639.5, 511.5}, looking_at({50, 0, 600}, {0, 0, 0}, 0),
                          {{0, 0, 1}, {1}, {{100, {1.33}}}});
  const Place place;
  export_openptv({{{"a", model}}}, 0.01, place.file("out"), "rig.toml");
  const CameraModel back = import_openptv(place.file("out")).rig.cameras.at(0).model;
  ASSERT_EQ(back.stack().interfaces.size(), 1U);
  EXPECT_EQ(back.stack().interfaces[0].behind.index, 1.33);
  EXPECT_NEAR((*back.project({10, 20, 30}))[0], (*model.project({10, 20, 30}))[0], 1e-9);
}

RC_GTEST_PROP(Openptv, a_distortion_about_another_centre_is_replaced_and_the_difference_told, ()) {
  CameraIntrinsics lens = drawn_lens();
  const bool cubic = *rc::gen::arbitrary<bool>();
  if (cubic) lens.k2 = lens.k3 = 0;
  const CameraModel model(lens, drawn_pose());
  OpenptvSetup setup;
  const OpenptvExport result = to_openptv(model, 0.01, setup, "rig.toml");
  RC_ASSERT(result.worst_px < (cubic ? 0.01 : 1));  // a cubic one about elsewhere is nearly a cubic and decentred one
  const CameraModel back = from_openptv(result.camera, setup, OpenptvScale::columns, "back");
  for (int i = 0; i < 10; ++i) {
    const SightRay ray = model.ray({*real(0, 1279), *real(0, 1023)});
    const Point3 point = ray.origin_mm + 600 * ray.direction;
    const auto before = *model.project(point), after = *back.project(point);
    RC_ASSERT(std::hypot(before[0] - after[0], before[1] - after[1]) < 1.2 * result.worst_px + 1e-7);
  }
}

TEST(Openptv, says_what_is_wrong_with_a_file_and_where) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const auto ori = [](const std::string& text) { return refusal([&] { parse_openptv_ori(text, "c.ori"); }); };
  says(ori("1 2 3\n4 five 6"), "c.ori:2: omega, phi or kappa (rad) 'five' is no finite number");
  says(ori("1 2 3\n4 nan 6"), "c.ori:2: ");
  says(ori("1 2 3\n4 5 6\n"), "c.ori:3: ends before the rotation matrix");
  std::string flat = kOri;
  flat.replace(flat.find(" 70\n"), 4, " 0\n");
  says(ori(flat), "c.ori:9: the focal length '0' is not above 0 mm");
  OpenptvCamera camera;
  says(refusal([&] { parse_openptv_addpar("0 0 0 0 0 0 0", "c.addpar", camera); }), "c.addpar:1: scx '0'");
  const auto par = [](const std::string& text) { return refusal([&] { parse_openptv_setup(text, "ptv.par"); }); };
  says(par("17\n"), "ptv.par:1: the number of cameras '17' is no whole number from 1 to 16");
  std::string fields = kSetup;
  fields.replace(fields.find("0.0125\n0\n"), 9, "0.0125\n1\n");
  says(par(fields), "interlaced");
  const Folder folder;
  std::filesystem::remove(folder.place().file("cal/b.tif.ori"));
  says(refusal([&] { import_openptv(folder.place().file("")); }), "names 'cal/b.tif' and there is no cal/b.tif.ori");
}

TEST(Openptv, says_what_it_has_no_words_for) {
  const auto says = [](const Rig& rig, const std::string& part) {
    const Place place;
    const std::string text = refusal([&] { export_openptv(rig, 0.01, place.file("out"), "rig.toml"); });
    EXPECT_NE(text.find(part), std::string::npos) << text;
    EXPECT_TRUE(text.starts_with("rig.toml: camera 'a")) << text;
    EXPECT_FALSE(std::filesystem::exists(place.file("out")));
  };
  const CameraIntrinsics lens{1280, 1024, 5800, 5800, 639.5, 511.5};
  const CameraPose pose = looking_at({0, 0, 600}, {0, 0, 0}, 0);
  const RefractiveStack water{{0, 0, 1}, {1}, {{100, {1.33}}}};
  says({{{"a b", CameraModel(lens, pose)}}}, "has a space");
  says({{{"a", CameraModel(lens, pose, {{0, 0, 1}, {1}, {{120, {1.5}}, {110, {1.4}}, {100, {1.33}}}})}}},
       "3 interfaces");
  says({{{"a", CameraModel(lens, pose, {{0, 0, 1}, {1}, {{-100, {1.33}}}})}}}, "move the origin");
  says({{{"b", CameraModel(lens, pose, water)}, {"a", CameraModel(lens, pose)}}}, "other media");
  CameraIntrinsics small = lens;
  small.width_px = 640;
  says({{{"b", CameraModel(lens, pose)}, {"a", CameraModel(small, pose)}}}, "640x1024");
}

}  // namespace
}  // namespace rptv
