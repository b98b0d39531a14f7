// SPDX-License-Identifier: MIT
// The C library does what the linker does, and says what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "tracking/rptv_linker.h"

namespace {

using Handle = std::unique_ptr<rptv_linker, decltype(&rptv_linker_free)>;

Handle made(const char* settings) { return {rptv_linker_new(settings, nullptr, 0), rptv_linker_free}; }

std::vector<rptv_track> next(rptv_linker* linker, std::uint64_t frame, const std::vector<double>& x) {
  const std::vector<double> zero(x.size());
  std::vector<rptv_track> tracks(x.size());
  rptv_linker_next(linker, frame, static_cast<std::int64_t>(frame) * 10'000'000, x.size(), x.data(), zero.data(),
                   zero.data(), nullptr, tracks.data());
  return tracks;
}

TEST(CLibrary, follows_particles_and_tells_which_have_gone) {
  const Handle linker = made("search_range_mm = 1.0\nmemory = 0");
  ASSERT_NE(linker, nullptr);
  next(linker.get(), 0, {0, 10});
  const auto tracks = next(linker.get(), 1, {10.5, NAN});
  EXPECT_EQ(tracks[0].id, 1U);
  EXPECT_EQ(tracks[0].age, 1U);
  EXPECT_NEAR(tracks[0].vx, 50, 1e-9);
  EXPECT_EQ(tracks[1].id, RPTV_NO_TRACK);
  EXPECT_EQ(rptv_linker_ended(linker.get())[0], 0U);
  EXPECT_EQ(rptv_linker_live(linker.get()), 1U);
}

TEST(CLibrary, predicts_and_starts_with_a_known_flow) {
  const Handle linker = made("search_range_mm = 0.1\npredict = \"velocity\"");
  const double position[3] = {0, 0, 0};
  const double velocity[3] = {100, 0, 0};
  ASSERT_EQ(rptv_linker_seed(linker.get(), 1, position, velocity), 0);
  next(linker.get(), 0, {0});
  EXPECT_EQ(next(linker.get(), 1, {1.05})[0].id, 0U) << "100 mm/s for 10 ms";
  rptv_track expected;
  ASSERT_EQ(rptv_linker_predict(linker.get(), 20'000'000, &expected, 1), 1U);
  EXPECT_NEAR(expected.x, 2.1, 1e-9);
}

TEST(CLibrary, goes_on_from_a_snapshot) {
  const Handle first = made("search_range_mm = 1.0");
  const Handle second = made("search_range_mm = 1.0");
  next(first.get(), 0, {0, 10, 20});
  std::vector<char> bytes(rptv_linker_snapshot(first.get(), nullptr, 0));
  EXPECT_EQ(rptv_linker_snapshot(first.get(), bytes.data(), bytes.size()), bytes.size());
  ASSERT_EQ(rptv_linker_restore(second.get(), bytes.data(), bytes.size(), nullptr, 0), 0);
  EXPECT_EQ(next(second.get(), 1, {20})[0].id, 2U);
  char error[200];
  EXPECT_EQ(rptv_linker_restore(second.get(), bytes.data(), 5, error, sizeof error), -1);
  EXPECT_THAT(error, testing::HasSubstr("snapshot"));
}

TEST(CLibrary, says_which_setting_it_refuses) {
  char error[200];
  EXPECT_EQ(rptv_linker_new("search_rnge_mm = 1.0", error, sizeof error), nullptr);
  EXPECT_THAT(error, testing::HasSubstr("did you mean 'search_range_mm'"));
  EXPECT_EQ(rptv_linker_new("search_range_mm = -1.0", error, sizeof error), nullptr);
  EXPECT_THAT(error, testing::HasSubstr("search_range_mm"));
  char short_error[8];
  EXPECT_EQ(rptv_linker_new("memory = -1", short_error, sizeof short_error), nullptr);
  EXPECT_EQ(std::string(short_error).size(), 7U);
}

}  // namespace
