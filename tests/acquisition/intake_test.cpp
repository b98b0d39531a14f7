// SPDX-License-Identifier: MIT
// Intake, from one thread: what it says to bad options, and under which cause it counts each kind of bad frame.
#include "acquisition/intake.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/acquisition/made_frame.hpp"

namespace rptv {
namespace {

using testing::HasSubstr;

std::string refusal(std::size_t cameras, const IntakeOptions& options) {
  try {
    const Intake intake(small_cameras(cameras), options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    return error.what();
  }
  return "accepted";
}

TEST(Intake, refuses_a_source_without_cameras_or_with_too_many) {
  EXPECT_THAT(refusal(0, {}), HasSubstr("0 cameras; 1 to 16 can be used"));
  EXPECT_THAT(refusal(kMaxCameras + 1, {}), HasSubstr("17 cameras; 1 to 16 can be used"));
}

TEST(Intake, says_how_many_slots_its_patience_needs) {
  EXPECT_THAT(refusal(2, {Newest{}, 10, 4}), HasSubstr("set it to 11 or more"));
  EXPECT_EQ(refusal(2, {Newest{}, 11, 4}), "accepted");
  EXPECT_EQ(refusal(1, {Newest{}, 1, 4}), "accepted") << "one camera needs no bundling";
}

// One camera, room for all that the test delivers.
class OneCamera : public testing::Test {
 protected:
  std::uint64_t lost(LossCause cause) const { return intake_.losses(0).of(cause); }
  std::vector<std::uint64_t> indices() {
    std::vector<std::uint64_t> found;
    for (FrameSet set; intake_.next(set, 0) == Taken::value;) {
      EXPECT_TRUE(is_whole(set, 1));
      found.push_back(set.info().index);
    }
    return found;
  }
  Intake intake_{small_cameras(1), {Bounded{16}, 16, 4}};
};

TEST_F(OneCamera, takes_the_first_index_as_it_comes) {
  send(intake_, 0, 65'400);
  EXPECT_EQ(indices(), (std::vector<std::uint64_t>{65'400}));
  EXPECT_EQ(intake_.losses(0).total(), 0U);
}

TEST_F(OneCamera, counts_every_skipped_index_as_a_gap) {
  for (const std::uint64_t index : {10U, 11U, 15U, 16U}) send(intake_, 0, index);
  EXPECT_EQ(lost(LossCause::source_gap), 3U);
  EXPECT_EQ(indices().size(), 4U);
  EXPECT_EQ(intake_.delivered(0), 4U);
}

TEST_F(OneCamera, counts_no_gap_that_the_source_has_explained) {
  send(intake_, 0, 10);
  intake_.lose(0, LossCause::source_torn, 2);
  send(intake_, 0, 13);
  EXPECT_EQ(lost(LossCause::source_torn), 2U);
  EXPECT_EQ(lost(LossCause::source_gap), 0U);
  send(intake_, 0, 15);
  EXPECT_EQ(lost(LossCause::source_gap), 1U) << "an explanation is good for one jump only";
}

TEST_F(OneCamera, does_not_take_a_duplicate_that_the_source_reports_for_an_explanation) {
  send(intake_, 0, 10);
  intake_.lose(0, LossCause::source_duplicate, 1);
  send(intake_, 0, 12);
  EXPECT_EQ(lost(LossCause::source_gap), 1U);
}

TEST_F(OneCamera, drops_a_frame_that_comes_twice_and_one_that_comes_late) {
  for (const std::uint64_t index : {1U, 3U, 3U, 2U, 4U}) send(intake_, 0, index);
  EXPECT_EQ(lost(LossCause::source_duplicate), 1U);
  EXPECT_EQ(lost(LossCause::set_stale), 1U);
  EXPECT_EQ(lost(LossCause::source_gap), 1U) << "the late one's gap stays counted";
  EXPECT_EQ(indices(), (std::vector<std::uint64_t>{1, 3, 4}));
}

TEST_F(OneCamera, drops_frames_that_are_torn_or_of_another_shape_or_empty) {
  send(intake_, 0, 1, true);
  intake_.deliver(made_frame({}, 0, 2));
  Frame wide = made_frame(intake_.claim(0), 0, 3);
  wide.shape.width_px = 16;
  intake_.deliver(std::move(wide));
  send(intake_, 0, 4);
  EXPECT_EQ(lost(LossCause::source_torn), 3U);
  EXPECT_EQ(lost(LossCause::source_gap), 0U);
  EXPECT_EQ(indices(), (std::vector<std::uint64_t>{4}));
  EXPECT_EQ(intake_.free_slots(0), 16U);
}

TEST_F(OneCamera, keeps_no_lease_of_a_frame_that_it_refuses) {
  send(intake_, 0, 1);
  Frame twice = made_frame(intake_.claim(0), 0, 1);
  intake_.deliver(std::move(twice));
  EXPECT_FALSE(twice.lease);  // NOLINT(bugprone-use-after-move): that is the question
  EXPECT_EQ(intake_.free_slots(0), 15U);
}

TEST_F(OneCamera, counts_a_claim_that_finds_no_slot_and_the_gap_it_explains_only_once) {
  send(intake_, 0, 1);
  std::vector<FrameLease> all;
  while (intake_.free_slots(0) > 0) all.push_back(intake_.claim(0));
  EXPECT_FALSE(send(intake_, 0, 2));
  EXPECT_FALSE(send(intake_, 0, 3));
  all.clear();
  send(intake_, 0, 4);
  EXPECT_EQ(lost(LossCause::pool_empty), 2U);
  EXPECT_EQ(lost(LossCause::source_gap), 0U);
}

TEST_F(OneCamera, refuses_frames_after_the_end_and_hands_out_what_came_before) {
  send(intake_, 0, 1);
  FrameLease in_hand = intake_.claim(0);
  intake_.end();
  EXPECT_FALSE(intake_.claim(0));
  intake_.deliver(made_frame(std::move(in_hand), 0, 2));
  EXPECT_EQ(lost(LossCause::after_close), 1U);
  EXPECT_EQ(indices(), (std::vector<std::uint64_t>{1}));
  FrameSet set;
  EXPECT_EQ(intake_.next(set, kLongNs), Taken::closed);
}

TEST(Intake, gives_the_newest_frame_and_counts_those_it_replaced) {
  Intake intake(small_cameras(1), {Newest{}, 4, 4});
  for (const std::uint64_t index : {1U, 2U, 3U}) send(intake, 0, index);
  FrameSet set;
  ASSERT_EQ(intake.next(set, 0), Taken::value);
  EXPECT_EQ(set.info().index, 3U);
  EXPECT_EQ(intake.losses(0).of(LossCause::superseded), 2U);
  EXPECT_EQ(intake.next(set, 0), Taken::timeout);
  EXPECT_EQ(set.cameras, 0U) << "next() drops what the set held";
  EXPECT_EQ(intake.free_slots(0), 4U);
}

TEST(Intake, gives_frames_of_a_device_clock_their_host_time_and_leaves_others_alone) {
  Intake intake(small_cameras(1), {Bounded{4}, 8, 4});
  FrameSet set;
  for (const ClockId clock : {ClockId::device, ClockId::ptp, ClockId::recording}) {
    Frame frame = made_frame(intake.claim(0), 0, 10 + static_cast<std::uint64_t>(clock));
    frame.info.clock = clock;
    frame.info.exposure_end_ns = 1'000'000 * static_cast<std::int64_t>(clock);
    frame.info.exposure_end_host_ns = 7;
    frame.info.arrival_ns = 9'000'000'000 + frame.info.exposure_end_ns;
    intake.deliver(std::move(frame));
    ASSERT_EQ(intake.next(set, 0), Taken::value);
    const std::int64_t mapped_ns = 9'000'000'000 + set.info().exposure_end_ns;
    EXPECT_EQ(set.info().exposure_end_host_ns, clock == ClockId::recording ? 7 : mapped_ns);
  }
  EXPECT_TRUE(intake.clock_mapping(0).valid);
  EXPECT_EQ(intake.clock_mapping(0).offset_ns, 9'000'000'000);
}

TEST(Intake, counts_what_comes_to_a_full_bounded_queue) {
  Intake intake(small_cameras(1), {Bounded{2}, 4, 4});
  for (const std::uint64_t index : {1U, 2U, 3U}) send(intake, 0, index);
  EXPECT_EQ(intake.losses(0).of(LossCause::over_bound), 1U);
  FrameSet set;
  ASSERT_EQ(intake.next(set, 0), Taken::value);
  EXPECT_EQ(set.info().index, 1U);
}

}  // namespace
}  // namespace rptv
