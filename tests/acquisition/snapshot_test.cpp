// SPDX-License-Identifier: MIT
// `rapidptv snapshot` as a process, on live cameras and on a recording: the files hold what the cameras sent.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "replay/image_file.hpp"
#include "tests/acquisition/gvsp_device.hpp"
#include "tests/acquisition/gvsp_image.hpp"
#include "tests/acquisition/payload.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

std::string rig(const std::string& cameras, const std::string& pixel_format) {
  return "schema = 1\nsource.kind = \"aravis\"\n[aravis]\ncameras = [" + cameras + "]\npixel_format = \"" +
         pixel_format + "\"\nregion = [0, 0, 128, 96]\nrate_hz = 100\nexposure_us = 2500\npacket_size = 1400\n";
}

/// The number of the image that a file holds, 0 when a byte of it is wrong.
std::uint64_t number_in(const std::filesystem::path& file, const std::string& pixel_format, std::uint32_t bits) {
  const auto reader = open_image(file);
  EXPECT_EQ(reader->header(0).significant_bits, bits);
  const ImageShape shape = reader->header(0).shape;
  EXPECT_EQ(shape.width_px, 128U);
  EXPECT_EQ(shape.height_px, 96U);
  FramePool pool(1, shape.bytes());
  Frame frame{.info = {}, .shape = shape, .lease = pool.claim()};
  reader->decode(0, {frame.lease.get(), shape.bytes()});
  const std::vector<std::uint8_t> sent = payload_of(frame, pixel_format);
  return sequence_of(sent.data(), sent.size());
}

TEST(Snapshot, writes_every_bit_of_a_live_image_and_says_how_it_is_exposed) {
  const Place place;
  const GvspDevice device("127.0.22.1", {});
  const std::string file = place.file("focus.png").string();
  const auto config = place.write("rig.toml", rig("\"127.0.22.1\"", "Mono12p"));
  const testing::Said said = testing::run_rapidptv({"snapshot", config.string(), "-o", file});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_GT(number_in(file, "Mono12p", 12), 0U);
  EXPECT_THAT(said.out, HasSubstr("127.0.22.1: " + file + ", 128 × 96 px, 12 bit; values 0 to "));
  EXPECT_THAT(said.out, HasSubstr("exposure 2500 us"));
}

TEST(Snapshot, writes_a_file_for_each_camera_named_after_it) {
  const Place place;
  const GvspDevice left("127.0.22.2", {}), right("127.0.22.3", {});
  const auto config = place.write("rig.toml", rig("\"127.0.22.2\", \"127.0.22.3\"", "Mono8"));
  const std::string folder = place.file("").string();
  const testing::Said said = testing::run_rapidptv({"snapshot", config.string(), "-o", folder, "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  for (const std::string name : {"127.0.22.2", "127.0.22.3"}) {
    EXPECT_GT(number_in(place.file(name + ".png"), "Mono8", 8), 0U) << name;
    EXPECT_THAT(said.out, HasSubstr("{\"camera\": \"" + name + "\", \"file\": "));
  }
}

TEST(Snapshot, takes_the_first_image_of_a_recording_and_counts_its_grey_values) {
  const Place place;
  std::vector<std::uint8_t> pixels(64, 10);
  pixels[0] = 255;
  pixels[1] = 0;
  const ImageShape shape{8, 8, 1};
  std::filesystem::create_directory(place.file("images"));
  write_png(place.file("images/1.png"), {reinterpret_cast<const std::byte*>(pixels.data()), shape});
  const auto config = place.write("rig.toml", "schema = 1\n[replay]\npath = \"images\"\nrate_hz = 10\n");
  const std::string file = place.file("first.png").string();
  const testing::Said said = testing::run_rapidptv({"snapshot", config.string(), "-o", file, "--json"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr(R"("minimum": 0, "maximum": 255, "mean": 13.671875, "saturated": 0.015625, )"));
}

TEST(Snapshot, says_what_it_waited_for_when_no_image_comes) {
  const Place place;
  const GvspDevice device("127.0.22.4", {});
  const auto config = place.write("rig.toml", rig("\"127.0.22.4\"", "Mono8"));
  const testing::Said said = testing::run_rapidptv({"snapshot", config.string(), "--set", "aravis.trigger=Line0",
                                                    "--patience", "0.3", "-o", place.file("x").string()});
  EXPECT_EQ(said.code, 69);
  EXPECT_THAT(said.err, HasSubstr("trigger Line0"));
  EXPECT_FALSE(std::filesystem::exists(place.file("x")));
}

}  // namespace
}  // namespace rptv
