// SPDX-License-Identifier: MIT
// A preloaded replay takes no memory once it runs.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "core/wake.hpp"
#include "replay/replay_source.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/replay/image_maker.hpp"

namespace rptv::testing {
namespace {

/// Gives slots, drops frames, and counts allocations from the 20th frame to the end.
class CountingSink final : public FrameSink {
 public:
  CountingSink(std::uint32_t cameras, std::size_t bytes) {
    for (std::uint32_t camera = 0; camera < cameras; ++camera) pools_.push_back(std::make_unique<FramePool>(4, bytes));
  }
  FrameLease claim(std::uint32_t camera) noexcept override { return pools_[camera]->claim(); }
  void deliver(Frame&& frame) noexcept override {
    const Frame mine = std::move(frame);
    if (delivered_.fetch_add(1) == 20) counter_.emplace();
  }
  void lose(std::uint32_t, LossCause, std::uint64_t) noexcept override {}
  void end() noexcept override {
    allocated_ = counter_->disarm();
    ended_.store(true);
    wake_.notify();
  }
  void wait_for_end() {
    for (int i = 0; i < 60 && !ended_.load(); ++i) {
      const std::uint32_t seen = wake_.prepare();
      if (!ended_.load()) wake_.wait(seen, 1'000'000'000);
    }
  }
  std::uint64_t delivered() const { return delivered_.load(); }
  std::uint64_t allocated_while_playing() const { return allocated_; }
  bool ended() const { return ended_.load(); }

 private:
  std::vector<std::unique_ptr<FramePool>> pools_;
  std::atomic<std::uint64_t> delivered_{0};
  std::optional<AllocationCounter> counter_;
  std::uint64_t allocated_ = 0;  // before ended_
  std::atomic<bool> ended_{false};
  Wake wake_;
};

TEST(PreloadedReplay, takes_no_memory_while_it_plays) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer owns malloc here";
  const TemporaryFolder folder;
  for (int camera = 0; camera < 2; ++camera)
    for (int frame = 0; frame < 10; ++frame)
      write_png(folder / ("cam" + std::to_string(camera) + "_" + std::to_string(frame) + ".png"),
                make_picture(40, 30, 2, 1).view());
  ReplaySettings settings;
  settings.path = folder.path().string();
  settings.rate_hz = 4000;
  settings.loop = 50;
  settings.preload = true;
  settings.faults.drop_fraction = settings.faults.duplicate_fraction = settings.faults.torn_fraction = 0.1;
  settings.faults.reorder_fraction = settings.faults.bunch_fraction = settings.faults.clock_jump_fraction = 0.1;
  ReplaySource source(settings);
  CountingSink sink(2, source.cameras()[0].shape.bytes());
  source.start(sink);
  sink.wait_for_end();
  ASSERT_TRUE(sink.ended());
  source.stop();
  EXPECT_GT(sink.delivered(), 800U);
  EXPECT_EQ(sink.allocated_while_playing(), 0U);
}

}  // namespace
}  // namespace rptv::testing
