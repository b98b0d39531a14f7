// SPDX-License-Identifier: MIT
// The configuration as a whole: defaults, paths, text; and what `check` finds in rigs that are not in order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "daemon/config.hpp"
#include "daemon/config_check.hpp"
#include "tests/daemon/bad_rig.hpp"

namespace rptv {
namespace {

using testing::BadInput;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Rig;

TEST(Config, defaults_print_and_read_back_as_they_are) {
  const std::string printed = to_toml(Config{});
  EXPECT_EQ(to_toml(parse_config(printed, "rig.toml")), printed);
  EXPECT_THAT(printed, HasSubstr("[linker]\n"));
  EXPECT_THAT(to_json(Config{}), HasSubstr("\"intake\": {\"policy\": \"newest\", \"depth\": 8"));
}

TEST(Config, paths_in_a_file_count_from_its_folder_and_those_of_a_command_line_from_here) {
  const Config config = parse_config(
      "replay.path = 'frames'\nlight_field.calibration = '/abs/c.toml'\noutput.tracks = '-'\noutput.points = "
      "'../p.csv'",
      "/rigs/one/rig.toml", {"publisher.curve_secret_key_file=key"});
  EXPECT_EQ(config.replay.path, "/rigs/one/frames");
  EXPECT_EQ(config.light_field.calibration, "/abs/c.toml");
  EXPECT_EQ(config.output.tracks, "-");
  EXPECT_EQ(config.output.points, "/rigs/p.csv");
  EXPECT_EQ(config.publisher.curve_secret_key_file, "key");
  EXPECT_EQ(config.light_field.background_image, "");
}

TEST(Config, intake_policies_reach_the_intake_with_their_depth) {
  const auto options = [](const char* policy) {
    return parse_config("intake.depth = 5", "rig.toml", {std::string("intake.policy=") + policy}).intake.options();
  };
  EXPECT_TRUE(std::holds_alternative<Newest>(options("newest").policy));
  EXPECT_EQ(std::get<Lossless>(options("lossless").policy).depth, 5U);
  EXPECT_EQ(std::get<Bounded>(options("bounded").policy).depth, 5U);
}

TEST(CheckConfig, finds_nothing_wrong_with_a_rig_that_is_in_order) {
  const Rig rig;
  const auto results = check_config(rig.config(), {});
  EXPECT_EQ(first_failure(results), nullptr) << to_text(results);
  EXPECT_EQ(results.size(), 6U) << to_text(results);
  EXPECT_THAT(to_json(results), HasSubstr("{\"ok\": true, \"exit_code\": 0, "));
}

TEST(CheckConfig, goes_on_after_a_failure_with_what_does_not_need_it) {
  const Rig rig;
  rig.replace(rig.calibration(), "80.0", "-1.0");
  const auto results = check_config(rig.config(), {});
  const std::string text = to_text(results);
  EXPECT_THAT(text, HasSubstr("failed   calibration"));
  EXPECT_THAT(text, HasSubstr("ok       source"));
  EXPECT_THAT(text, HasSubstr("skipped  reconstruction"));
  EXPECT_THAT(text, HasSubstr("ok       publisher"));
  EXPECT_THAT(to_json(results), HasSubstr("{\"ok\": false, \"exit_code\": 78, "));
}

TEST(CheckConfig, warns_where_a_run_would_start_but_disappoint) {
  const Rig rig;
  EXPECT_THAT(to_text(check_config(rig.config(), {"intake.policy=newest"})), HasSubstr("warning  source"));
}

class CheckBadInput : public ::testing::TestWithParam<BadInput> {};

TEST_P(CheckBadInput, is_told_in_one_line_with_its_exit_code) {
  const BadInput& bad = GetParam();
  if (bad.needs_other_user && geteuid() == 0) GTEST_SKIP() << "root may do everything";
  Rig rig;
  bad.spoil(rig);
  const auto results = check_config(rig.config(), {});
  const CheckResult* failed = first_failure(results);
  ASSERT_NE(failed, nullptr) << to_text(results);
  EXPECT_EQ(failed->code, bad.code) << failed->text;
  EXPECT_THAT(failed->text, Not(HasSubstr("\n")));
  for (const auto& word : bad.words) EXPECT_THAT(failed->text, HasSubstr(word));
}

INSTANTIATE_TEST_SUITE_P(All, CheckBadInput, ::testing::ValuesIn(testing::bad_inputs()),
                         [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace rptv
