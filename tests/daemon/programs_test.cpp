// SPDX-License-Identifier: MIT
// rapidptv's executables: which libraries each loads, and that users see one command.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "tests/daemon/run_binary.hpp"

namespace rptv::testing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::string output_of(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) text += static_cast<char>(c);
  EXPECT_EQ(pclose(pipe), 0) << command;
  return text;
}

std::string program(const char* suffix) { return std::getenv("RAPIDPTV") + std::string(suffix); }

// Ceres itself may be linked statically: what it needs may not.
TEST(Programs, load_opencv_and_the_solvers_of_ceres_to_calibrate_only) {
  EXPECT_THAT(output_of("ldd " + program("-calibrate")), AllOf(HasSubstr("libopencv_aruco"), HasSubstr("libcholmod")));
  for (const char* suffix : {"", "-daemon"})
    EXPECT_THAT(output_of("ldd " + program(suffix)),
                AllOf(HasSubstr("libstdc++"), Not(HasSubstr("libopencv")), Not(HasSubstr("libcholmod"))));
}

TEST(Programs, are_one_command_to_users) {
  const Said all = run_rapidptv({"--help"}), one = run_rapidptv({"calibrate", "--help"});
  EXPECT_EQ(all.code, 0);
  EXPECT_THAT(all.out, AllOf(HasSubstr("  calibrate  "), HasSubstr("  link  "), HasSubstr("  run  ")));
  EXPECT_EQ(one.code, 0);
  EXPECT_THAT(one.out, AllOf(HasSubstr("rapidptv calibrate"), HasSubstr("wand"), HasSubstr("lenslets")));
  EXPECT_EQ(output_of(program("-daemon") + " calibrate --help"), one.out);
  const Said unknown = run_rapidptv({"calibrat"});
  EXPECT_EQ(unknown.code, 64);
  EXPECT_THAT(unknown.err, HasSubstr("there is no command 'calibrat'"));
}

}  // namespace
}  // namespace rptv::testing
