// SPDX-License-Identifier: MIT
// `rapidptv check --hardware` as a process, on GigE Vision cameras on loopback.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/acquisition/gvsp_device.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

// On a configuration of these cameras: text for aravis.cameras.
testing::Said check(const std::string& cameras, std::vector<std::string> words) {
  const Place place;
  const auto rig = place.write(
      "rig.toml", "schema = 1\n[source]\nkind = 'aravis'\n[sync]\ntolerance_us = 9900\n[aravis]\ncameras = [" +
                      cameras + "]\nregion = [0, 0, 128, 96]\nrate_hz = 50\npacket_size = 1400\n");
  words.insert(words.begin(), {"check", rig.string(), "--hardware"});
  return testing::run_rapidptv(words);
}

TEST(CheckHardware, tells_of_each_camera_what_it_gave) {
  const GvspDevice left("127.0.0.11", {}), right("127.0.0.12", {});
  const std::string both = "'127.0.0.11', '127.0.0.12'";
  const testing::Said said = check(both, {"--set", "sync.mode=device", "--seconds", "2"});
  EXPECT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, ContainsRegex("camera 127.0.0.11 streaming, [0-9]+ frames"));
  EXPECT_THAT(said.out, ContainsRegex("  [0-9.]+ Hz, clock [+-][0-9.]+ s and [+-][0-9.]+ ppm from the host's, lost: "));
  EXPECT_THAT(said.out, HasSubstr(", skew P50 "));
  EXPECT_THAT(said.out, ContainsRegex("[0-9]+ sets in [0-9.]+ s"));
  const testing::Said json = check(both, {"--set", "sync.mode=device", "--seconds", "2", "--json"});
  EXPECT_THAT(json.out, HasSubstr(R"({"ok":true,"problem":"","elapsed_s":)"));
  const testing::Said none = check(both, {"--set", "sync.mode=none", "--seconds", "1", "--json"});
  EXPECT_THAT(none.out, HasSubstr(R"("warnings":["sync.mode = 'none')"));
  const testing::Said unset = check(both, {});
  EXPECT_EQ(unset.code, 78);
  EXPECT_THAT(unset.err, HasSubstr("sync.mode is unset"));
}

TEST(CheckHardware, names_the_likely_cause_when_a_camera_gives_nothing) {
  const GvspDevice camera("127.0.0.13", {.loss = 1, .answers_resend = false});
  const testing::Said said = check("'127.0.0.13'", {"--seconds", "1"});
  EXPECT_EQ(said.code, 69);
  EXPECT_THAT(said.err,
              ContainsRegex("127.0.0.13: no frame for [0-9.]+ s: no packet ever came: wrong network interface"));
  EXPECT_THAT(said.out, HasSubstr("camera 127.0.0.13 streaming, 0 frames"));
}

TEST(CheckHardware, says_that_no_set_was_made_of_cameras_that_both_give_frames) {
  const GvspDevice left("127.0.0.11", {}), right("127.0.0.12", {});
  const testing::Said said = check("'127.0.0.11', '127.0.0.12'", {"--set", "sync.mode=ptp", "--seconds", "1"});
  EXPECT_EQ(said.code, 69);
  EXPECT_THAT(said.err, HasSubstr("none of them belong together"));
  EXPECT_THAT(said.out, HasSubstr("set_untimed")) << "these cameras have no PTP";
}

TEST(CheckHardware, has_nothing_to_do_without_hardware) {
  const Place place;
  const testing::Said said = testing::run_rapidptv(
      {"check", place.write("rig.toml", "schema = 1\n[replay]\npath = '.'\n").string(), "--hardware"});
  EXPECT_EQ(said.code, 78);
  EXPECT_THAT(said.err, HasSubstr("no hardware to check"));
}

}  // namespace
}  // namespace rptv
