// SPDX-License-Identifier: MIT
// Lossless with several cameras: nothing is lost that could be paired, and nothing ever waits for ever.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "tests/acquisition/hostile_camera.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

using Indices = std::vector<std::uint64_t>;

IntakeOptions lossless(std::int64_t stall_ns) { return {Lossless{2}, 12, 4, stall_ns}; }

Indices seen_by_all(const std::vector<Expected>& cameras) {
  Indices common = cameras[0].accepted;
  for (const Expected& one : cameras) {
    Indices both;
    std::set_intersection(common.begin(), common.end(), one.accepted.begin(), one.accepted.end(),
                          std::back_inserter(both));
    common = both;
  }
  return common;
}

std::vector<Shot> perfect(std::uint64_t first, std::uint64_t last) {
  Faults faults;
  faults.first = first;
  faults.last = last;
  return script_of(faults, 0);
}

// Every camera shows its last frame, so none is silent; however far one is ahead, it waits.
RC_GTEST_PROP(LosslessIntake, publishes_exactly_what_all_cameras_saw, ()) {
  const auto cameras = *rc::gen::inRange<std::size_t>(2, 5);
  const auto seed = *rc::gen::arbitrary<std::uint64_t>();
  std::vector<std::vector<Shot>> scripts;
  for (std::size_t camera = 0; camera < cameras; ++camera) {
    Faults faults;
    faults.drop = *rc::gen::inRange(0, 30);
    faults.duplicate = *rc::gen::inRange(0, 30);
    faults.torn = *rc::gen::inRange(0, 30);
    faults.delay = *rc::gen::inRange(0, 30);
    faults.first += *rc::gen::inRange<std::uint64_t>(0, 60);
    faults.leaves_at = faults.first + 50;
    faults.away = *rc::gen::inRange<std::uint64_t>(0, 60);
    scripts.push_back(script_of(faults, seed + camera));
    scripts.back().push_back({faults.last + 1});
  }
  std::vector<Expected> expected;
  Intake intake(small_cameras(cameras), lossless(kLongNs));
  const Found found = run_cameras(intake, scripts, expected, *rc::gen::element(0, 5));
  const std::string wrong = account(intake, found, expected, 12);
  if (!wrong.empty()) RC_FAIL(wrong);
  RC_ASSERT(found.indices == seen_by_all(expected));
}

// Plays (camera, index) in this order in one thread, as a reader of image files does.
Found play_in_one_thread(Intake& intake, const std::vector<std::pair<std::uint32_t, std::uint64_t>>& order) {
  std::thread reader([&] {
    for (const auto& [camera, index] : order) send(intake, camera, index);
    intake.end();
  });
  const Found found = consume(intake, 0);
  reader.join();
  return found;
}

TEST(LosslessIntake, loses_nothing_when_one_thread_reads_all_cameras_in_turn) {
  Intake intake(small_cameras(4), lossless(kLongNs));
  std::vector<std::pair<std::uint32_t, std::uint64_t>> order;
  const std::uint64_t count = rounds(20'000);
  for (std::uint64_t index = 0; index < count; ++index)
    for (std::uint32_t camera = 0; camera < 4; ++camera) order.emplace_back((camera + index) % 4, index);
  const Found found = play_in_one_thread(intake, order);
  EXPECT_EQ(found.end, Taken::closed);
  EXPECT_EQ(found.broken_sets, 0U);
  EXPECT_EQ(found.indices.size(), count);
  for (std::uint32_t camera = 0; camera < 4; ++camera) EXPECT_EQ(intake.losses(camera).total(), 0U);
}

// The thread that would bring the partner is the one that waits: only giving up can free it.
TEST(LosslessIntake, comes_free_when_the_thread_that_waits_is_the_one_that_is_waited_for) {
  Intake intake(small_cameras(2), lossless(1'000'000));
  std::vector<std::pair<std::uint32_t, std::uint64_t>> order;
  for (std::uint32_t camera = 0; camera < 2; ++camera)
    for (std::uint64_t index = 0; index < 300; ++index) order.emplace_back(camera, index);
  const Found found = play_in_one_thread(intake, order);
  EXPECT_EQ(found.end, Taken::closed);
  EXPECT_EQ(found.broken_sets, 0U);
  for (std::uint32_t camera = 0; camera < 2; ++camera) {
    EXPECT_EQ(intake.delivered(camera), 300U);
    EXPECT_EQ(found.indices.size() + lost_after_delivery(intake.losses(camera)), 300U);
    EXPECT_EQ(intake.free_slots(camera), 12U);
  }
  EXPECT_LE(found.indices.size(), 9U) << "what camera 0 could hold: its bundler queue, its lane, the frame in hand";
}

RC_GTEST_PROP(LosslessIntake, comes_free_whatever_order_one_thread_reads_in, ()) {
  const auto cameras = *rc::gen::inRange<std::uint32_t>(2, 5);
  const auto turns = *rc::gen::container<std::vector<std::uint32_t>>(300, rc::gen::inRange<std::uint32_t>(0, cameras));
  std::vector<std::pair<std::uint32_t, std::uint64_t>> order;
  std::vector<std::uint64_t> next(cameras, 0);
  for (const std::uint32_t camera : turns) order.emplace_back(camera, next[camera]++);
  Intake intake(small_cameras(cameras), lossless(1'000));
  const Found found = play_in_one_thread(intake, order);
  RC_ASSERT(found.end == Taken::closed);
  RC_ASSERT(found.broken_sets == 0U);
  for (std::uint32_t camera = 0; camera < cameras; ++camera) {
    RC_ASSERT(intake.delivered(camera) == next[camera]);
    RC_ASSERT(found.indices.size() + lost_after_delivery(intake.losses(camera)) == next[camera]);
    RC_ASSERT(intake.free_slots(camera) == 12U);
  }
}

// Waiting 100 ms for the silent camera at every frame would take longer than the consumer's patience.
TEST(LosslessIntake, waits_for_a_silent_camera_once_and_not_at_every_frame) {
  Intake intake(small_cameras(3), lossless(100'000'000));
  std::vector<Expected> expected;
  const Found found = run_cameras(intake, {perfect(1, 1000), perfect(1, 1000), {}}, expected, 0);
  EXPECT_EQ(account(intake, found, expected, 12), "");
  EXPECT_TRUE(found.indices.empty());
  EXPECT_EQ(intake.losses(0).of(LossCause::set_incomplete), 1000U);
}

// The bound is paid once, in the silence; long enough that no busy machine holds the returned camera up for so long.
TEST(LosslessIntake, pairs_every_frame_again_once_a_silent_camera_has_returned) {
  Intake intake(small_cameras(2), lossless(1'000'000'000));
  std::vector<Expected> expected(2);
  std::atomic<bool> silence_is_over{false}, has_returned{false};
  std::thread steady([&] {
    feed(intake, 0, perfect(1, 500), expected[0]);
    silence_is_over = true;
    while (!has_returned) std::this_thread::yield();
    feed(intake, 0, perfect(501, 1000), expected[0]);
  });
  std::thread returning([&] {
    while (!silence_is_over) std::this_thread::yield();
    feed(intake, 1, perfect(501, 501), expected[1]);
    has_returned = true;
    feed(intake, 1, perfect(502, 1000), expected[1]);
    steady.join();
    intake.end();
  });
  const Found found = consume(intake, 0);
  returning.join();
  EXPECT_EQ(account(intake, found, expected, 12), "");
  ASSERT_EQ(found.indices.size(), 500U);
  EXPECT_EQ(found.indices.front(), 501U);
  EXPECT_EQ(intake.losses(1).total(), 0U);
}

}  // namespace
}  // namespace rptv
