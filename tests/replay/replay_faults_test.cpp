// SPDX-License-Identifier: MIT
// What a replay injects is what the real intake counts, in every run the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/intake.hpp"
#include "replay/replay_source.hpp"
#include "tests/replay/collecting_sink.hpp"
#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

constexpr std::int64_t kMinute_ns = 60'000'000'000;

class ReplayFaultsTest : public ::testing::Test {
 protected:
  static constexpr std::uint32_t kCameras = 3;

  ReplayFaultsTest() {
    for (std::uint32_t camera = 0; camera < kCameras; ++camera)
      for (std::uint32_t frame = 0; frame < 40; ++frame)
        write_png(folder / ("cam" + std::to_string(camera) + "_" + std::to_string(frame) + ".png"),
                  make_picture(16, 12, 1, camera * 100 + frame).view());
    settings.path = folder.path().string();
    settings.rate_hz = 1000;
    settings.speed = 0;
    settings.preload = true;
    settings.loop = 10;
  }
  /// Everything delivered under the present settings, sorted by camera.
  std::vector<Received> play(const ReplaySource*& played) {
    source = std::make_unique<ReplaySource>(settings);
    CollectingSink sink(*source, 4096);
    source->start(sink);
    EXPECT_TRUE(sink.wait_for_end());
    source->stop();
    played = source.get();
    return sink.received();
  }
  TemporaryFolder folder;
  ReplaySettings settings;
  std::unique_ptr<ReplaySource> source;
};

TEST_F(ReplayFaultsTest, are_what_the_intake_counts) {
  settings.faults.drop_fraction = 0.1;
  settings.faults.duplicate_fraction = 0.1;
  settings.faults.torn_fraction = 0.1;
  settings.faults.bunch_fraction = 0.2;
  settings.faults.reorder_fraction = 0.2;
  settings.first_index = 65400;
  ReplaySource replay(settings);
  Intake intake(replay.cameras(), {Lossless{8}, 24, 4});
  replay.start(intake);
  FrameSet set;
  std::uint64_t sets = 0;
  while (intake.next(set, kMinute_ns) == Taken::value) ++sets;
  replay.stop();
  for (std::uint32_t camera = 0; camera < kCameras; ++camera) {
    const InjectedFaults injected = replay.injected(camera);
    const Losses& losses = intake.losses(camera);
    EXPECT_GT(injected.dropped, 20U);
    EXPECT_GT(injected.reordered + injected.bunched, 20U);
    EXPECT_EQ(losses.of(LossCause::source_gap), injected.dropped);
    EXPECT_EQ(losses.of(LossCause::source_duplicate), injected.duplicated);
    EXPECT_EQ(losses.of(LossCause::source_torn), injected.torn);
    EXPECT_EQ(sets + losses.total() - injected.duplicated, 400U) << "every instant is a set or one loss";
  }
}

TEST_F(ReplayFaultsTest, are_the_same_in_every_run_and_at_every_speed) {
  settings.faults.drop_fraction = 0.1;
  settings.faults.torn_fraction = 0.1;
  settings.faults.duplicate_fraction = 0.1;
  settings.faults.clock_jump_fraction = 0.05;
  settings.loop = 2;
  using Seen = std::tuple<std::uint64_t, bool, std::int64_t, std::vector<std::byte>>;
  std::vector<std::vector<Seen>> runs;
  for (const double speed : {0.0, 0.0, 5.0}) {
    settings.speed = speed;
    const ReplaySource* played = nullptr;
    std::vector<Seen> seen;
    for (const Received& frame : play(played))
      if (frame.info.camera == 1)
        seen.emplace_back(frame.info.index, frame.info.torn, frame.info.exposure_end_ns, frame.picture.pixels);
    runs.push_back(std::move(seen));
  }
  EXPECT_EQ(runs[0], runs[1]);
  EXPECT_EQ(runs[0], runs[2]);
}

TEST_F(ReplayFaultsTest, never_drop_the_first_or_the_last_instant) {
  settings.faults.drop_fraction = 1;
  const ReplaySource* played = nullptr;
  const auto received = play(played);
  EXPECT_EQ(received.size(), 2 * kCameras);
  EXPECT_EQ(played->injected(0).dropped, 398U);
}

TEST_F(ReplayFaultsTest, tear_the_lower_rows_off) {
  settings.faults.torn_fraction = 1;
  settings.loop = 1;
  const ReplaySource* played = nullptr;
  std::size_t whole = 0;
  for (const Received& frame : play(played)) {
    EXPECT_TRUE(frame.info.torn);
    const Picture original =
        make_picture(16, 12, 1, frame.info.camera * 100 + static_cast<std::uint32_t>(frame.info.index));
    whole += frame.picture == original ? 1 : 0;
    EXPECT_EQ(frame.picture.pixels.back(), std::byte{0});
  }
  EXPECT_EQ(whole, 0U);
  EXPECT_EQ(played->injected(2).torn, 40U);
}

TEST_F(ReplayFaultsTest, reorder_cameras_but_not_the_frames_of_one) {
  settings.faults.reorder_fraction = 0.5;
  settings.loop = 2;
  const ReplaySource* played = nullptr;
  const auto received = play(played);
  std::array<std::uint64_t, kCameras> next{};
  std::uint64_t late = 0;
  for (const Received& frame : received) {
    EXPECT_EQ(frame.info.index, next[frame.info.camera]++);
    bool last = true;
    for (std::uint32_t other = 0; other < kCameras; ++other)
      last = last && (other == frame.info.camera || next[other] > frame.info.index + 1);
    late += last ? 1 : 0;
  }
  std::uint64_t injected = 0;
  for (std::uint32_t camera = 0; camera < kCameras; ++camera) injected += played->injected(camera).reordered;
  EXPECT_EQ(injected, 40U) << "every even instant";
  EXPECT_GE(late, injected) << "each came after the next frame of both other cameras";
}

TEST_F(ReplayFaultsTest, bunch_frames_at_the_deadline_of_the_last) {
  settings.faults.bunch_fraction = 0.4;
  settings.speed = 2;
  settings.loop = 1;
  const ReplaySource* played = nullptr;
  const auto received = play(played);
  const FaultPlan plan(settings.faults);
  std::uint64_t held = 0;
  for (const Received& frame : received) {
    const std::int64_t own_ns = frame.info.exposure_end_host_ns;
    std::int64_t periods = 0;
    while (frame.info.index + static_cast<std::uint64_t>(periods) < 39 &&
           plan.waits_for_next(frame.info.index + static_cast<std::uint64_t>(periods), frame.info.camera))
      ++periods;
    EXPECT_GE(frame.info.arrival_ns, own_ns + periods * 500'000 - 1);
    held += periods > 0 ? 1 : 0;
  }
  EXPECT_GT(held, 10U);
  EXPECT_EQ(held, played->injected(0).bunched + played->injected(1).bunched + played->injected(2).bunched);
}

TEST_F(ReplayFaultsTest, shift_the_clock_for_good_but_not_the_host_times) {
  settings.faults.clock_jump_fraction = 0.1;
  settings.faults.clock_jump_ns = -2'500'000;
  settings.loop = 1;
  const ReplaySource* played = nullptr;
  std::array<std::int64_t, kCameras> shift{};
  for (const Received& frame : play(played)) {
    const std::int64_t now = frame.info.exposure_end_ns - static_cast<std::int64_t>(frame.info.index) * 1'000'000;
    std::int64_t& last = shift[frame.info.camera];
    EXPECT_TRUE(now == last || now == last - 2'500'000);
    last = now;
  }
  for (std::uint32_t camera = 0; camera < kCameras; ++camera)
    EXPECT_EQ(shift[camera], -2'500'000 * static_cast<std::int64_t>(played->injected(camera).clock_jumps));
  EXPECT_LT(shift[0], 0);
}

}  // namespace
}  // namespace rptv::testing
