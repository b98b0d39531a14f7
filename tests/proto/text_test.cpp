// SPDX-License-Identifier: MIT
// Messages as lines and JSON, and the count of what a subscriber lost.
#include "proto/text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "proto/encode.hpp"
#include "tests/proto/made_result.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

TEST(Text, writes_json_with_null_for_not_a_number) {
  Encoder encoder("session", 8, 8);
  Result result(8, 8);
  fill_result(result, 42, 2);
  result.tracks.x_mm = {std::numeric_limits<double>::quiet_NaN(), 0.5};
  Stamps stamps = result.stamps;
  WireMessage message;
  ASSERT_EQ(decode(encoder.tracks(result, stamps), message), "");
  const std::string json = to_json(message, 0);
  EXPECT_THAT(json, HasSubstr(R"("topic":"tracks")"));
  EXPECT_THAT(json, HasSubstr(R"("frame":42)"));
  EXPECT_THAT(json, HasSubstr(R"("particle":[1,2])"));
  EXPECT_THAT(json, HasSubstr(R"("x":[null,0.5])"));
}

TEST(Text, says_on_one_line_what_a_frame_holds) {
  Encoder encoder("session", 8, 8);
  Result result(8, 8);
  fill_result(result, 42, 4);
  result.tracks.push_death(9);
  Stamps stamps = result.stamps;
  WireMessage message;
  ASSERT_EQ(decode(encoder.tracks(result, stamps), message), "");
  EXPECT_EQ(to_line(message, message.stamps[Stage::exposure_end] + 7'250'000),
            "frame 42  t 0.420000 s  tracks 4  births 2  deaths 1  latency 7.250 ms");
}

TEST(SequenceCheck, counts_what_is_missing_and_starts_afresh_with_a_new_session) {
  SequenceCheck check;
  WireMessage message;
  message.session = "first";
  message.sequence = 10;
  EXPECT_EQ(check.missing_before(Topic::tracks, message), 0U);
  message.sequence = 14;
  EXPECT_EQ(check.missing_before(Topic::tracks, message), 3U);
  EXPECT_EQ(check.missing_before(Topic::particles, message), 0U);
  message.session = "second";
  message.sequence = 100;
  EXPECT_EQ(check.missing_before(Topic::tracks, message), 0U);
  EXPECT_EQ(check.missing(), 3U);
}

}  // namespace
}  // namespace rptv
