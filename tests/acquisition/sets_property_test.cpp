// SPDX-License-Identifier: MIT
// Sets of cameras that start late, drop, repeat, miss triggers, leave and return: each set is of one instant.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "acquisition/bundler.hpp"
#include "tests/acquisition/synced_cameras.hpp"

namespace rptv {
namespace {

using Triggers = std::vector<std::uint64_t>;

constexpr std::int64_t kToleranceNs = 4'000'000;
constexpr std::int64_t kMostJitterNs = kToleranceNs / 2;  // of two cameras: together the tolerance
constexpr std::int64_t kBoundNs = 35'000'000;
constexpr std::size_t kPatience = 4;

PairingOptions one_trigger(const TriggerTrain& train) { return {PairBy::index_and_time, train.ptp, kToleranceNs}; }

// What came of the frames.
struct Outcome {
  Triggers sets;
  std::uint64_t mixed = 0;      ///< sets whose frames are not of one trigger
  std::uint64_t backwards = 0;  ///< sets that are not newer than the one before, by index or by trigger
  std::uint64_t overdue = 0;    ///< frames that waited for more than the bound
  std::vector<std::uint64_t> offered, lost, skewed;
};

// A bundler in the frames' own time: it is called when a frame arrives and when a bound ends, as the intake does.
class VirtualTime {
 public:
  VirtualTime(std::size_t cameras, const PairingOptions& pairing)
      : pool_(cameras * (kPatience + 4), 16), losses_(cameras) {
    std::vector<Losses*> pointers;
    for (Losses& one : losses_) pointers.push_back(&one);
    bundler_ = std::make_unique<Bundler>(
        std::move(pointers),
        BundlerOptions{.room = kPatience + 2, .patience = kPatience, .bound_ns = kBoundNs, .pairing = pairing});
    outcome_.offered.resize(cameras);
    last_index_.resize(cameras);
  }

  Outcome play(const std::vector<Shown>& frames) {
    for (const Shown& shown : frames) {
      const std::int64_t now_ns = shown.info.arrival_ns;
      while (bundler_->deadline_ns() <= now_ns && outcome_.overdue == 0) take_all(bundler_->deadline_ns());
      std::uint64_t& last = last_index_[shown.info.camera];
      if (shown.info.index <= last) continue;  // the intake counts those
      last = shown.info.index;
      ++outcome_.offered[shown.info.camera];
      bundler_->offer(shown_frame(pool_.claim(), shown), now_ns);
      take_all(now_ns);
    }
    while (bundler_->give_up_oldest()) take_all(frames.back().info.arrival_ns);
    for (const Losses& one : losses_) {
      outcome_.lost.push_back(one.total());
      outcome_.skewed.push_back(one.of(LossCause::set_skew));
    }
    return outcome_;
  }
  bool gave_every_slot_back() const { return pool_.free_slots() == pool_.slots(); }

 private:
  void take_all(std::int64_t now_ns) {
    for (FrameSet set; bundler_->take(set, now_ns);) {
      if (!is_of_one_trigger(set, losses_.size())) ++outcome_.mixed;
      const std::uint64_t trigger = trigger_of(set.frames[0]);
      const bool newer = outcome_.sets.empty() || (trigger > outcome_.sets.back() && set.info().index > last_set_);
      if (!newer) ++outcome_.backwards;
      for (const Frame& frame : set.all())
        if (now_ns - frame.info.arrival_ns > kBoundNs) ++outcome_.overdue;
      outcome_.sets.push_back(trigger);
      last_set_ = set.info().index;
    }
    if (bundler_->deadline_ns() <= now_ns) ++outcome_.overdue;
  }

  FramePool pool_;
  std::vector<Losses> losses_;
  std::unique_ptr<Bundler> bundler_;
  Outcome outcome_;
  Triggers last_index_;
  std::uint64_t last_set_ = 0;
};

TriggerTrain any_train() {
  TriggerTrain train;
  train.jitter_ns = *rc::gen::inRange<std::int64_t>(0, kMostJitterNs);
  train.pause_ns = *rc::gen::element<std::int64_t>(0, 0, 70'000'000, 900'000'000);
  train.ptp = *rc::gen::arbitrary<bool>();
  return train;
}

SyncedCamera any_camera() {
  const auto percent = rc::gen::weightedOneOf<int>({{2, rc::gen::just(0)}, {1, rc::gen::inRange(0, 30)}});
  SyncedCamera camera;
  camera.first = *rc::gen::element<std::uint64_t>(0, 0, 1, 7, 90);
  camera.drop = *percent;
  camera.repeat = *percent;
  camera.drift_ppm = *rc::gen::inRange(-100, 101);
  camera.first_id = *rc::gen::element<std::uint64_t>(1, 65'400, 65'535, 40'000);
  return camera;
}

std::vector<SyncedCamera> any_cameras(const std::function<void(SyncedCamera&)>& harm) {
  std::vector<SyncedCamera> cameras(*rc::gen::inRange<std::size_t>(2, 5));
  for (SyncedCamera& camera : cameras) {
    camera = any_camera();
    harm(camera);
  }
  return cameras;
}

void leave_and_return(SyncedCamera& camera) {
  camera.miss = *rc::gen::element(0, 0, 1, 5);
  if (*rc::gen::arbitrary<bool>()) return;
  camera.leaves_at = camera.first + *rc::gen::inRange<std::uint64_t>(0, 150);
  const auto away = *rc::gen::element<std::uint64_t>(1, 3, 40, 1000);
  camera.returns_at = camera.leaves_at + away;
  camera.missed_guess = *rc::gen::element<std::uint64_t>(0, away, away + 2, away / 2, 5000);
  camera.clock_starts_anew = *rc::gen::arbitrary<bool>();
}

void expect_sound(const Outcome& outcome) {
  RC_ASSERT(outcome.mixed == 0U);
  RC_ASSERT(outcome.backwards == 0U);
  RC_ASSERT(outcome.overdue == 0U);
  for (std::size_t camera = 0; camera < outcome.offered.size(); ++camera)
    RC_ASSERT(outcome.sets.size() + outcome.lost[camera] == outcome.offered[camera]);
}

RC_GTEST_PROP(Sets, are_of_one_instant_in_order_in_time_and_lose_nothing_uncounted, ()) {
  const TriggerTrain train = any_train();
  const std::vector<SyncedCamera> cameras = any_cameras(leave_and_return);
  VirtualTime time(cameras.size(), one_trigger(train));
  const Outcome outcome = time.play(show(cameras, train, *rc::gen::arbitrary<std::uint64_t>()));
  expect_sound(outcome);
  RC_ASSERT(time.gave_every_slot_back());
  RC_TAG(std::string(outcome.sets.empty() ? "no set" : "sets"));
}

Triggers seen_by_all(const std::vector<Shown>& frames, std::size_t cameras) {
  std::map<std::uint64_t, std::set<std::uint32_t>> seen;
  for (const Shown& shown : frames) seen[shown.trigger].insert(shown.info.camera);
  Triggers all;
  for (const auto& [trigger, by] : seen)
    if (by.size() == cameras) all.push_back(trigger);
  return all;
}

RC_GTEST_PROP(Sets, hold_every_instant_that_all_cameras_saw_however_late_one_started, ()) {
  TriggerTrain train = any_train();
  const std::vector<SyncedCamera> cameras = any_cameras([](SyncedCamera&) {});
  const std::vector<Shown> frames = show(cameras, train, *rc::gen::arbitrary<std::uint64_t>());
  for (const PairBy by : {PairBy::index_and_time, PairBy::time}) {
    VirtualTime time(cameras.size(), {by, train.ptp, kToleranceNs});
    const Outcome outcome = time.play(frames);
    expect_sound(outcome);
    RC_ASSERT(outcome.sets == seen_by_all(frames, cameras.size()));
  }
}

// From the trigger on, and with a little time to find the offsets again, every instant makes a set.
void expect_sets_from(std::uint64_t trigger, const std::vector<SyncedCamera>& cameras, const TriggerTrain& train) {
  VirtualTime time(cameras.size(), one_trigger(train));
  const Outcome outcome = time.play(show(cameras, train, 1));
  EXPECT_EQ(outcome.mixed + outcome.backwards + outcome.overdue, 0U);
  const auto after = std::count_if(outcome.sets.begin(), outcome.sets.end(), [&](auto t) { return t >= trigger; });
  EXPECT_EQ(static_cast<std::uint64_t>(after), train.triggers - trigger);
}

TEST(Sets, are_found_again_when_a_camera_returns_and_counts_from_anywhere) {
  for (const std::uint64_t guess : {0U, 3U, 39U, 40U, 41U, 5000U}) {
    std::vector<SyncedCamera> cameras(3);
    cameras[1].leaves_at = 100;
    cameras[1].returns_at = 140;
    cameras[1].missed_guess = guess;
    cameras[1].clock_starts_anew = true;
    expect_sets_from(140, cameras, {});
  }
}

TEST(Sets, go_on_without_harm_when_a_camera_misses_a_trigger_unnoticed) {
  std::vector<SyncedCamera> cameras(2);
  cameras[1].leaves_at = 100;  // one trigger, and its ids go on as if nothing had been
  cameras[1].returns_at = 101;
  for (const std::uint64_t guess : {0U, 1U, 2U, 3U}) {
    cameras[1].missed_guess = guess;
    expect_sets_from(108, cameras, {});
  }
}

TEST(Sets, count_frames_whose_index_fits_and_whose_time_does_not) {
  std::vector<SyncedCamera> cameras(2);
  cameras[1].leaves_at = 100;
  cameras[1].returns_at = 101;
  const TriggerTrain train;
  VirtualTime time(2, one_trigger(train));
  const Outcome outcome = time.play(show(cameras, train, 1));
  EXPECT_EQ(outcome.skewed[0], 1U) << "its partner missed this trigger and counts on as if it had not";
  EXPECT_EQ(outcome.sets.size(), train.triggers - 1);
}

TEST(Sets, of_free_running_cameras_lie_within_the_tolerance) {
  std::vector<Shown> frames = show({SyncedCamera{}, SyncedCamera{.drift_ppm = 80, .first_id = 9}}, {}, 1);
  for (Shown& shown : frames) {  // the second camera runs half a percent slower: its phase goes round
    if (shown.info.camera == 0) continue;
    shown.info.exposure_end_host_ns += static_cast<std::int64_t>(shown.trigger) * 50'000;
    shown.info.arrival_ns = shown.info.exposure_end_host_ns;
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const Shown& a, const Shown& b) { return a.info.arrival_ns < b.info.arrival_ns; });
  VirtualTime time(2, {PairBy::time, false, kToleranceNs});
  const Outcome outcome = time.play(frames);
  EXPECT_EQ(outcome.overdue, 0U);
  EXPECT_GT(outcome.sets.size(), 230U) << "at 40 % of the period either way, four of five find a partner";
  EXPECT_EQ(outcome.sets.size() + outcome.lost[0], outcome.offered[0]);
  EXPECT_EQ(outcome.sets.size() + outcome.lost[1], outcome.offered[1]);
}

TEST(Sets, take_no_frame_into_ptp_time_that_has_none) {
  VirtualTime time(2, {PairBy::index_and_time, true, kToleranceNs});
  const Outcome outcome = time.play(show({SyncedCamera{}, SyncedCamera{}}, {.triggers = 20}, 1));
  EXPECT_TRUE(outcome.sets.empty());
  EXPECT_EQ(outcome.lost, (std::vector<std::uint64_t>{20, 20}));
}

}  // namespace
}  // namespace rptv
