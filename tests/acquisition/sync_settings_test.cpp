// SPDX-License-Identifier: MIT
// [sync]: what several cameras must say, and what one need not.
#include "acquisition/sync_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"

namespace rptv {
namespace {

using testing::HasSubstr;

std::string refusal(const SyncSettings& settings, std::size_t cameras, std::int64_t period_ns) {
  IntakeOptions options;
  try {
    settings.apply(options, cameras, period_ns);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    return error.what();
  }
  return "accepted";
}

IntakeOptions applied(const std::string& mode) {
  IntakeOptions options;
  SyncSettings{.mode = mode, .tolerance_us = 250, .bound_ms = 20}.apply(options, 2, 0);
  return options;
}

TEST(SyncSettings, make_several_cameras_choose_and_name_the_choices) {
  EXPECT_THAT(refusal({}, 3, 0),
              HasSubstr("3 cameras; say what keeps them in step: 'hardware', 'ptp', 'device' or 'n"));
  EXPECT_EQ(refusal({}, 1, 0), "accepted");
  EXPECT_EQ(refusal({.mode = "device"}, 3, 0), "accepted");
}

TEST(SyncSettings, refuse_a_tolerance_that_confuses_one_frame_with_the_next) {
  EXPECT_THAT(refusal({.mode = "hardware", .tolerance_us = 1000}, 2, 2'000'000), HasSubstr("set it below 1000"));
  EXPECT_EQ(refusal({.mode = "hardware", .tolerance_us = 999}, 2, 2'000'000), "accepted");
  EXPECT_EQ(refusal({.mode = "none", .tolerance_us = 1000}, 2, 2'000'000), "accepted") << "nothing is compared";
  EXPECT_EQ(SyncSettings{.mode = "ptp"}.confusion(1, 1'000), "") << "one camera is compared with nobody";
  EXPECT_EQ(SyncSettings{.mode = "ptp"}.confusion(2, 0), "") << "nobody knows the period";
}

TEST(SyncSettings, mean_what_they_are_called) {
  EXPECT_EQ(applied("hardware").pairing.by, PairBy::index_and_time);
  EXPECT_FALSE(applied("hardware").pairing.ptp);
  EXPECT_EQ(applied("hardware").pairing.tolerance_ns, 250'000);
  EXPECT_EQ(applied("hardware").bound_ns, 20'000'000);
  EXPECT_EQ(applied("ptp").pairing.by, PairBy::index_and_time);
  EXPECT_TRUE(applied("ptp").pairing.ptp);
  EXPECT_EQ(applied("device").pairing.by, PairBy::time);
  EXPECT_EQ(applied("none").pairing.by, PairBy::index);
}

TEST(SyncSettings, warn_of_sets_that_nothing_checks) {
  EXPECT_THAT(SyncSettings{.mode = "none"}.warning(2), HasSubstr("choose 'hardware', 'ptp' or 'device'"));
  EXPECT_EQ(SyncSettings{.mode = "none"}.warning(1), "");
  EXPECT_EQ(SyncSettings{.mode = "ptp"}.warning(2), "");
}

}  // namespace
}  // namespace rptv
