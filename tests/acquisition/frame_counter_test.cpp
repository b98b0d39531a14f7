// SPDX-License-Identifier: MIT
// Frame ids of 16, 32 and 64 bits become indices that only grow, through wraps, losses, late frames and reconnections.
#include "acquisition/frame_counter.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <vector>

#include "acquisition/pixel_format.hpp"

namespace rptv {
namespace {

std::uint16_t wire_id(std::uint64_t n) { return static_cast<std::uint16_t>((n - 1) % 65535 + 1); }

TEST(FrameCounter, goes_on_from_65535_to_1) {
  FrameCounter counter;
  EXPECT_EQ(counter.index_of(65534), 65534U);
  EXPECT_EQ(counter.index_of(65535), 65535U);
  EXPECT_EQ(counter.index_of(1), 65536U);
  EXPECT_EQ(counter.index_of(3), 65538U) << "2 was lost";
}

TEST(FrameCounter, gives_late_and_repeated_frames_their_own_index) {
  FrameCounter counter;
  counter.index_of(65535);
  counter.index_of(2);
  EXPECT_EQ(counter.index_of(65535), 65535U);
  EXPECT_EQ(counter.index_of(1), 65536U);
  EXPECT_EQ(counter.index_of(2), 65537U);
  EXPECT_EQ(counter.index_of(3), 65538U);
}

TEST(FrameCounter, goes_on_from_the_last_of_32_bits_to_0) {
  FrameCounter counter(FrameCounter::Width::bits32);
  EXPECT_EQ(counter.index_of(UINT32_MAX - 1), 4294967294U);
  EXPECT_EQ(counter.index_of(0), 4294967296U);
  EXPECT_EQ(counter.index_of(UINT32_MAX), 4294967295U) << "it came late";
  EXPECT_EQ(counter.index_of(70'000), 4295037296U);
}

TEST(FrameCounter, takes_ids_of_more_bits_as_they_are) {
  for (const auto width : {FrameCounter::Width::bits16, FrameCounter::Width::bits64}) {
    FrameCounter counter(width);
    EXPECT_EQ(counter.index_of(65535), 65535U);
    EXPECT_EQ(counter.index_of(65536), 65536U);
    EXPECT_EQ(counter.index_of(10'000'000'000), 10'000'000'000U);
  }
}

TEST(FrameCounter, goes_on_with_larger_indices_after_a_reconnection) {
  FrameCounter counter;
  counter.index_of(900);
  counter.reopen(0);
  EXPECT_EQ(counter.index_of(1), 901U);
  counter.reopen(40);
  EXPECT_EQ(counter.index_of(7), 942U);
  EXPECT_EQ(counter.index_of(8), 943U);
}

RC_GTEST_PROP(FrameCounterProperty, follows_any_steps_below_half_a_turn, ()) {
  std::uint64_t n = *rc::gen::inRange<std::uint64_t>(1, 65536);
  FrameCounter counter;
  RC_ASSERT(counter.index_of(wire_id(n)) == n);
  for (const auto step : *rc::gen::container<std::vector<std::uint64_t>>(rc::gen::inRange<std::uint64_t>(0, 32000))) {
    n += step;
    RC_ASSERT(counter.index_of(wire_id(n)) == n);
  }
}

TEST(PixelFormat, says_how_many_bytes_an_image_takes) {
  EXPECT_EQ(find_pixel_format("Mono8")->payload_bytes(10), 10U);
  EXPECT_EQ(find_pixel_format("Mono12")->payload_bytes(10), 20U);
  EXPECT_EQ(find_pixel_format("RGB8"), nullptr);
}

}  // namespace
}  // namespace rptv
