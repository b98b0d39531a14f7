// SPDX-License-Identifier: MIT
// Scenario files: what is written reads back; what contradicts itself is refused with the next step.
#include "simulation/scenario.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.hpp"

namespace rptv {
namespace {

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    return error.what();
  }
  return "no error";
}

TEST(Scenario, reads_back_what_was_written) {
  ScenarioSettings scenario, read;
  scenario.seed = 77;
  scenario.flow.frequency_hz = 1.0 / 3.0;
  scenario.camera.noise = false;
  FieldList out, in;
  scenario.fields(out);
  read.fields(in);
  read_toml_text(to_toml(out, kScenarioSchema), "scenario.toml", "scenario", kScenarioSchema, in);
  EXPECT_EQ(read.seed, 77);
  EXPECT_EQ(read.flow.frequency_hz, 1.0 / 3.0);
  EXPECT_FALSE(read.camera.noise);
}

TEST(Scenario, default_is_consistent) { EXPECT_NO_THROW(check_scenario(ScenarioSettings{}, "default")); }

TEST(Scenario, every_shipped_one_reads) {
  int read = 0;
  for (const auto& entry : std::filesystem::directory_iterator(RPTV_SOURCE_DIR "/simulation/scenarios")) {
    EXPECT_NO_THROW(read_scenario(entry.path())) << entry.path();
    ++read;
  }
  EXPECT_GE(read, 3);
}

TEST(Scenario, refuses_a_box_that_reaches_the_focal_plane) {
  ScenarioSettings scenario;
  scenario.seeding.volume_z_mm = 21;
  EXPECT_THAT(message_of([&] { check_scenario(scenario, "deep.toml"); }),
              testing::AllOf(testing::HasSubstr("deep.toml"), testing::HasSubstr("no real image")));
}

TEST(Scenario, refuses_a_wall_above_the_fluid) {
  ScenarioSettings scenario;
  scenario.flow.wall_y_mm = 3.5;
  EXPECT_THAT(message_of([&] { check_scenario(scenario, "high.toml"); }), testing::HasSubstr("no fluid is left"));
}

TEST(Scenario, refuses_lenses_that_are_told_half) {
  ScenarioSettings scenario;
  scenario.main_lens.model = "prescription";
  EXPECT_THAT(message_of([&] { check_scenario(scenario, "s.toml"); }), testing::HasSubstr("prescription is missing"));
  scenario.main_lens.prescription = "double_gauss_f2";
  scenario.main_lens.rim_z_mm = {1};
  EXPECT_THAT(message_of([&] { check_scenario(scenario, "s.toml"); }), testing::HasSubstr("one radius per rim"));
  scenario.main_lens.model = "aplanat";
  EXPECT_THAT(message_of([&] { check_scenario(scenario, "s.toml"); }), testing::HasSubstr("magnification is missing"));
  scenario.main_lens.magnification = 20;
  EXPECT_THAT(message_of([&] { check_scenario(scenario, "s.toml"); }), testing::HasSubstr("window_mm 0.1 is nearer"));
}

TEST(Scenario, refuses_a_table_without_its_name) {
  ScenarioSettings scenario;
  scenario.flow.kind = "table";
  EXPECT_THAT(message_of([&] { check_scenario(scenario, "s.toml"); }), testing::HasSubstr("flow.table is missing"));
}

TEST(Scenario, refuses_a_file_that_is_not_there) {
  EXPECT_THROW(read_scenario(testing::TempDir() + "/no_such_scenario.toml"), Error);
}

}  // namespace
}  // namespace rptv
