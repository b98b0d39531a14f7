// SPDX-License-Identifier: MIT
// The real binary on bad input: one line on stderr that names file and value, the sysexits code, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "tests/daemon/bad_rig.hpp"
#include "tests/daemon/run_binary.hpp"

namespace rptv::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

void expect_refusal(const Said& said, ExitCode code, const std::vector<std::string>& words) {
  EXPECT_EQ(said.signal, 0) << said.err;
  EXPECT_EQ(said.code, static_cast<int>(code)) << said.err;
  EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1) << said.err;
  EXPECT_THAT(said.err, StartsWith("rapidptv: "));
  for (const auto& word : words) EXPECT_THAT(said.err, HasSubstr(word));
}

class BadInputs : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadInputs, end_run_and_check_alike) {
  const BadInput& bad = GetParam();
  Rig rig;
  bad.spoil(rig);
  for (const char* command : {"run", "check"}) {
    SCOPED_TRACE(command);
    expect_refusal(run_rapidptv({command, "--config", rig.config()}, bad.needs_other_user), bad.code, bad.words);
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadInputs, ::testing::ValuesIn(bad_inputs()),
                         [](const auto& bad) { return bad.param.name; });

TEST(Binary, runs_and_checks_the_rig_that_the_bad_ones_are_made_from) {
  const Rig rig;
  for (const char* command : {"run", "check"}) {
    const Said said = run_rapidptv({command, "--config", rig.config()}, true);
    EXPECT_EQ(said.code, 0) << command << ": " << said.err;
  }
}

TEST(Binary, prints_the_resolved_configuration_as_one_that_it_takes_back) {
  const Rig rig;
  const Said said = run_rapidptv({"show-config", rig.config(), "--set", "linker.memory=7"});
  ASSERT_EQ(said.code, 0) << said.err;
  EXPECT_THAT(said.out, HasSubstr("memory = 7\n"));
  EXPECT_THAT(said.out, HasSubstr((rig.folder / "frames").string()));
  std::ofstream(rig.folder / "again.toml") << said.out;
  EXPECT_EQ(run_rapidptv({"show-config", rig.folder / "again.toml"}).out, said.out);
  EXPECT_EQ(run_rapidptv({"check", rig.folder / "again.toml"}).code, 0);
}

TEST(Binary, says_why_it_cannot_have_the_gpu_that_it_must_have) {
  const Rig rig;
  const Said said = run_rapidptv({"run", "--config", rig.config(), "--backend", "cuda"});
  if (said.code == 0) GTEST_SKIP() << "this machine has a GPU";
  expect_refusal(said, ExitCode::unavailable,
                 {"reconstruction.backend = \"cuda\": ", "CUDA", "\"auto\" and \"cpu\" do without"});
  const Said automatic = run_rapidptv({"run", "--config", rig.config()});
  EXPECT_EQ(automatic.code, 0) << automatic.err;
  EXPECT_THAT(automatic.err, HasSubstr("reconstructing on the CPU: "));
  const Said cpu = run_rapidptv({"run", "--config", rig.config(), "--backend", "cpu"});
  EXPECT_EQ(cpu.code, 0) << cpu.err;
  EXPECT_THAT(cpu.err, HasSubstr("reconstructing on the CPU\n"));
}

TEST(Binary, refuses_a_backend_that_it_does_not_know) {
  const Rig rig;
  const Said said = run_rapidptv({"run", "--config", rig.config(), "--backend", "gpu"});
  EXPECT_EQ(said.code, static_cast<int>(ExitCode::usage));
  EXPECT_THAT(said.err, HasSubstr("--backend: gpu not in {auto,cuda,cpu}"));
  expect_refusal(run_rapidptv({"run", "--config", rig.config(), "--set", "reconstruction.backend=gpu"}),
                 ExitCode::usage, {"reconstruction.backend", "'cuda'"});
}

TEST(Binary, refuses_assignments_that_fit_no_setting) {
  const Rig rig;
  const auto set = [&](const char* assignment) {
    return run_rapidptv({"show-config", "--config", rig.config(), "--set", assignment});
  };
  expect_refusal(set("linker.memroy=1"), ExitCode::usage, {"did you mean 'memory'"});
  expect_refusal(set("linker.memory=many"), ExitCode::usage, {"linker.memory=many", "integer"});
  expect_refusal(run_rapidptv({"check", rig.config(), "--set", "linker.memory"}), ExitCode::usage, {"key=value"});
}

TEST(Binary, refuses_bad_images_in_reconstruct) {
  Rig rig;
  std::filesystem::resize_file(rig.frame(2), 200);
  const auto reconstruct = [&](const std::filesystem::path& images) {
    return run_rapidptv({"reconstruct", images, "--calibration", rig.calibration(), "-o", "-"});
  };
  expect_refusal(reconstruct(rig.folder / "frames"), ExitCode::bad_data, {"frame_00002.png"});
  expect_refusal(reconstruct(rig.folder / "absent"), ExitCode::no_input, {"absent"});
}

Said link_table(const std::string& points, const std::string& tracks) {
  return run_rapidptv({"link", points, "--search-range", "0.5", "--rate", "100", "-o", tracks});
}

TEST(Binary, refuses_bad_tables_in_link) {
  const Rig rig;
  const std::string table = rig.folder / "points.csv";
  const auto link = [&](const std::string& text) {
    std::ofstream(table) << text;
    return link_table(table, "-");
  };
  expect_refusal(link("frame,x,y,z\n0,1,2,3\n1,abc,2,3\n"), ExitCode::bad_data, {"points.csv:3: column 'x' is 'abc'"});
  expect_refusal(link("frame,x,y,z\n0,nan,2,3\n"), ExitCode::bad_data, {"points.csv:2", "not finite"});
  expect_refusal(link("frame;x;y;z\n0;1;2;3\n"), ExitCode::bad_data, {"no column 'frame'", "frame;x;y;z"});
  expect_refusal(link(""), ExitCode::bad_data, {"points.csv: is empty"});
  expect_refusal(link("frame,x,y,z\n2,1,2,3\n1,1,2,3\n"), ExitCode::bad_data, {"points.csv:3", "sort the rows"});
  expect_refusal(link_table(rig.folder / "none.csv", "-"), ExitCode::no_input, {"none.csv"});
}

TEST(Binary, says_when_the_disk_is_full) {
  const Rig rig;
  std::ofstream(rig.folder / "points.csv") << "frame,x,y,z\n0,1,2,3\n1,1,2,3\n";
  expect_refusal(link_table(rig.folder / "points.csv", "/dev/full"), ExitCode::io,
                 {"/dev/full", "No space left on device"});
}

}  // namespace
}  // namespace rptv::testing
