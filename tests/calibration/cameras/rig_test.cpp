// SPDX-License-Identifier: MIT
// Rig files: bit-exact there and back, and one clear line for what is wrong.
#include "calibration/cameras/rig.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "core/error.hpp"
#include "tests/calibration/cameras/sample_cameras.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

bool same(const RefractiveStack& a, const RefractiveStack& b) {
  const auto equal = [](const Interface& i, const Interface& j) {
    return i.position_mm == j.position_mm && i.behind.index == j.behind.index;
  };
  return a.before.index == b.before.index &&
         std::equal(a.interfaces.begin(), a.interfaces.end(), b.interfaces.begin(), b.interfaces.end(), equal) &&
         (a.interfaces.empty() || a.normal == b.normal);
}

const std::string kCamera =
    "name = \"left\"\nwidth_px = 640\nheight_px = 480\nfx_px = 900.0\nfy_px = 900.0\ncx_px = 319.5\ncy_px = 239.5\n"
    "rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]\ntranslation_mm = [0, 0, 500]\n";

std::string refusal(const std::string& text) {
  try {
    parse_rig(text, "rig.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return "";
}

RC_GTEST_PROP(Rig, comes_back_from_its_text_bit_for_bit, ()) {
  Rig rig;
  const int cameras = *rc::gen::inRange(1, 17);
  for (int i = 0; i < cameras; ++i) rig.cameras.push_back({"camera " + std::to_string(i), drawn_camera()});
  const Rig back = parse_rig(to_toml(rig), "rig.toml");
  RC_ASSERT(back.cameras.size() == rig.cameras.size());
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    RC_ASSERT(back.cameras[i].name == rig.cameras[i].name);
    RC_ASSERT(back.cameras[i].model.intrinsics() == rig.cameras[i].model.intrinsics());
    RC_ASSERT(back.cameras[i].model.pose() == rig.cameras[i].model.pose());
    RC_ASSERT(same(back.cameras[i].model.stack(), rig.cameras[i].model.stack()));
  }
  RC_ASSERT(to_toml(back) == to_toml(rig));
}

TEST(Rig, is_read_from_the_file_that_was_written) {
  const Place place;
  const Rig rig = parse_rig("[camera_1]\n" + kCamera, "rig.toml");
  write_rig(rig, place.file("rig.toml"));
  EXPECT_EQ(to_toml(read_rig(place.file("rig.toml"))), to_toml(rig));
  EXPECT_THROW(read_rig(place.file("none.toml")), Error);
  EXPECT_THROW(write_rig(rig, place.file("no/folder.toml")), Error);
}

TEST(Rig, says_what_is_wrong_with_a_file_and_where) {
  const auto says = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  const auto with = [](const std::string& line) { return "[camera_1]\n" + kCamera + line; };
  says(refusal(""), "has no camera");
  says(refusal(with("skew = 1.0\n")), "rig.toml:11:1: unknown key 'camera_1.skew' (did you mean 'skew_px'?)");
  says(refusal(with("k1 = nan\n")), "rig.toml:11:6: 'camera_1.k1' is nan");
  says(refusal(with("[camera_2]\nname = \"right\"\n")), "'camera_2.width_px' is missing");
  says(refusal(with("[camera_3]\n" + kCamera)), "'camera_2.name' is missing");
  says(refusal(with("[camera_2]\n" + kCamera)), "camera_2.name 'left' is another camera's");
  says(refusal(with("[camera_17]\n" + kCamera)), "unknown key 'camera_17");
  says(refusal(with("interface_normal = [0, 0, 1]\n")), "interface_positions_mm 0");
  says(refusal(with("interface_normal = [0, 0, -1]\ninterface_positions_mm = [600]\nmedia_indices = [1, 1.33]\n")),
       "rig.toml: camera_1: an interface at 600 mm");
  std::string turned = with("");
  turned.replace(turned.find("[1, 0, 0, 0"), 11, "[1, 0, 0, 1");
  says(refusal(turned), "rig.toml: camera_1: the rotation is none");
  says(refusal("schema = 2\n" + with("")), "newer than 1");
}

TEST(Rig, images_of_another_size_are_refused_by_name) {
  const Rig rig = parse_rig("[camera_1]\n" + kCamera, "rig.toml");
  EXPECT_NO_THROW(check_resolution(rig.cameras[0], 640, 480, "rig.toml"));
  try {
    check_resolution(rig.cameras[0], 480, 640, "rig.toml");
    FAIL() << "480x640 px were taken for 640x480";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "rig.toml: camera 'left' is calibrated for 640x480 px and its images have 480x640; use the region of "
                 "interest that it was calibrated with, or calibrate it as it is now");
  }
}

}  // namespace
}  // namespace rptv
