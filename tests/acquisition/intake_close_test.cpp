// SPDX-License-Identifier: MIT
// Intake, closed or destroyed in the middle of everything: all threads come free and every frame is accounted for.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "tests/acquisition/made_frame.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

TEST(ClosingAnIntake, wakes_a_camera_that_waits_for_a_slot) {
  for (const std::size_t cameras : {1U, 2U}) {
    Intake intake(small_cameras(cameras), {Lossless{2}, 11, 4});
    std::vector<FrameLease> all;
    while (intake.free_slots(0) > 0) all.push_back(intake.claim(0));
    std::thread camera([&] { EXPECT_FALSE(intake.claim(0)); });
    intake.close();
    camera.join();
    EXPECT_EQ(intake.losses(0).total(), 0U) << "no frame is lost when the stream has ended";
  }
}

TEST(ClosingAnIntake, wakes_a_camera_that_waits_for_its_partner) {
  Intake intake(small_cameras(2), {Lossless{2}, 11, 4, kLongNs});
  std::thread camera([&] {
    for (std::uint64_t index = 0; send(intake, 0, index); ++index) {
    }
  });
  while (intake.free_slots(0) > 2) std::this_thread::yield();  // queues full, one frame in hand
  intake.close();
  camera.join();
  FrameSet set;
  EXPECT_EQ(intake.next(set, kLongNs), Taken::closed);
  EXPECT_EQ(lost_after_delivery(intake.losses(0)), intake.delivered(0));
  EXPECT_EQ(intake.free_slots(0), 11U);
}

TEST(ClosingAnIntake, wakes_a_consumer_that_sleeps) {
  for (const std::size_t cameras : {1U, 3U}) {
    Intake intake(small_cameras(cameras), {});
    std::thread consumer([&] {
      FrameSet set;
      EXPECT_EQ(intake.next(set, kLongNs), Taken::closed);
    });
    intake.close();
    consumer.join();
  }
}

// Cameras run until they are refused; a third party closes at a moment that the round number chooses.
void close_in_the_middle(std::size_t cameras, const HandOverPolicy& policy, std::uint64_t moment) {
  Intake intake(small_cameras(cameras), {policy, 12, 4, 10'000});
  std::atomic<bool> stop{false};
  std::vector<std::thread> threads;
  for (std::uint32_t camera = 0; camera < cameras; ++camera)
    threads.emplace_back([&, camera] {
      for (std::uint64_t index = 1; !stop; ++index) {
        send(intake, camera, index);
        if (index % 16 == 0) std::this_thread::yield();  // else it holds a core against those who end the round
      }
    });
  threads.emplace_back([&] {
    while (intake.delivered(0) < moment) std::this_thread::yield();
    intake.close();
  });
  std::uint64_t sets = 0, broken = 0;
  FrameSet set;
  Taken end;
  while ((end = intake.next(set, kLongNs)) == Taken::value) {
    ++sets;
    broken += is_whole(set, cameras) ? 0 : 1;
  }
  stop = true;
  intake.close();
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(end, Taken::closed);
  EXPECT_EQ(broken, 0U);
  EXPECT_EQ(intake.next(set, 0), Taken::closed) << "nothing slips in behind the end";
  for (std::uint32_t camera = 0; camera < cameras; ++camera) {
    EXPECT_EQ(sets + lost_after_delivery(intake.losses(camera)), intake.delivered(camera));
    EXPECT_EQ(intake.free_slots(camera), 12U);
  }
}

TEST(ClosingAnIntake, accounts_for_every_frame_whenever_it_comes) {
  for (std::uint64_t i = 0; i < rounds(400); ++i)
    for (const std::size_t cameras : {1U, 3U}) {
      close_in_the_middle(cameras, Newest{}, i % 40);
      close_in_the_middle(cameras, Lossless{1 + i % 3}, i % 40);
      close_in_the_middle(cameras, Bounded{1 + i % 3}, i % 40);
    }
}

// The consumer has gone first: the bundling thread waits for room for its set, and must not for ever.
TEST(DestroyingAnIntake, frees_a_bundling_thread_whose_consumer_is_gone) {
  for (std::uint64_t i = 0; i < rounds(400); ++i) {
    auto intake = std::make_unique<Intake>(small_cameras(2), IntakeOptions{Lossless{1}, 11, 4});
    std::vector<std::thread> threads;
    for (std::uint32_t camera = 0; camera < 2; ++camera)
      threads.emplace_back([&, camera] {
        for (std::uint64_t index = 0; send(*intake, camera, index); ++index) {
        }
      });
    while (intake->delivered(0) < 3) std::this_thread::yield();
    intake->close();
    for (std::thread& thread : threads) thread.join();
    intake.reset();
  }
}

}  // namespace
}  // namespace rptv
