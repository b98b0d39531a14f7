// SPDX-License-Identifier: MIT
// Intake with a thread per camera on one trigger: whatever the threads do, sets are of one instant, and all is counted.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <atomic>
#include <memory>
#include <thread>

#include "tests/acquisition/synced_cameras.hpp"
#include "tests/core/workload.hpp"

namespace rptv {
namespace {

struct Taking {
  std::uint64_t sets = 0, mixed = 0;
  Taken end = Taken::timeout;
};

Taking take_all(Intake& intake) {
  Taking taking;
  FrameSet set;
  while ((taking.end = intake.next(set, kLongNs)) == Taken::value) {
    ++taking.sets;
    if (!is_of_one_trigger(set, intake.cameras())) ++taking.mixed;
  }
  return taking;
}

// Each camera's frames in a thread of its own, as fast as it can; the last one ends the stream.
Taking play(Intake& intake, const std::vector<Shown>& frames) {
  std::vector<std::thread> threads;
  std::atomic<std::size_t> running{intake.cameras()};
  for (std::uint32_t camera = 0; camera < intake.cameras(); ++camera)
    threads.emplace_back([&, camera] {
      for (const Shown& shown : frames) {
        if (shown.info.camera != camera) continue;
        if (FrameLease lease = intake.claim(camera)) intake.deliver(shown_frame(std::move(lease), shown));
      }
      if (--running == 0) intake.end();
    });
  const Taking taking = take_all(intake);
  for (std::thread& thread : threads) thread.join();
  return taking;
}

RC_GTEST_PROP(IntakeOfSyncedCameras, gives_sets_of_one_instant_and_counts_the_rest, ()) {
  TriggerTrain train{.triggers = rounds(2000), .jitter_ns = 1'000'000};
  std::vector<SyncedCamera> cameras(*rc::gen::inRange<std::size_t>(2, 5));
  for (SyncedCamera& camera : cameras) {
    camera.first = *rc::gen::element<std::uint64_t>(0, 3, 30);
    camera.drop = *rc::gen::inRange(0, 20);
    camera.repeat = *rc::gen::inRange(0, 20);
    camera.miss = *rc::gen::element(0, 0, 1);
    camera.drift_ppm = *rc::gen::inRange(-100, 101);
  }
  IntakeOptions options;
  options.policy = *rc::gen::element<HandOverPolicy>(Newest{}, Bounded{4}, Lossless{4});
  options.pairing = {*rc::gen::element(PairBy::index_and_time, PairBy::time), false, 4'000'000};
  options.bound_ns = *rc::gen::element<std::int64_t>(1'000, 1'000'000, kLongNs);
  options.stall_ns = 1'000'000;
  Intake intake(small_cameras(cameras.size()), options);
  const Taking taking = play(intake, show(cameras, train, *rc::gen::arbitrary<std::uint64_t>()));
  RC_ASSERT(taking.end == Taken::closed);
  RC_ASSERT(taking.mixed == 0U);
  for (std::uint32_t camera = 0; camera < cameras.size(); ++camera) {
    RC_ASSERT(taking.sets + lost_after_delivery(intake.losses(camera)) == intake.delivered(camera));
    RC_ASSERT(intake.free_slots(camera) == options.pool_frames_per_camera);
    RC_ASSERT(intake.skew(camera).max_ns <= 4'000'000);
  }
  RC_TAG(std::string(taking.sets == 0 ? "no set" : "sets"));
}

TEST(IntakeOfSyncedCameras, gives_an_incomplete_set_up_at_its_bound_when_no_further_frame_comes) {
  IntakeOptions options;
  options.policy = Bounded{4};
  options.pairing = {PairBy::time, false, 1'000'000};
  options.bound_ns = 5'000'000;
  Intake intake(small_cameras(2), options);
  send(intake, 0, 1);
  const std::int64_t deadline_ns = host_now_ns() + kLongNs;
  while (intake.losses(0).of(LossCause::set_incomplete) == 0 && host_now_ns() < deadline_ns) std::this_thread::yield();
  EXPECT_EQ(intake.losses(0).of(LossCause::set_incomplete), 1U);
  EXPECT_EQ(intake.free_slots(0), options.pool_frames_per_camera);
}

}  // namespace
}  // namespace rptv
