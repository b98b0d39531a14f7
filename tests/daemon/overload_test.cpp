// SPDX-License-Identifier: MIT
// A reconstruction that takes two frame periods for each frame, under each policy. Time is counted in frames: the
// camera takes one at each tick, and reconstructing gives two ticks.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>

#include "daemon/pipeline.hpp"
#include "tests/acquisition/made_frame.hpp"

namespace rptv {
namespace {

constexpr std::uint64_t kFrames = 400;
constexpr std::size_t kDepth = 4;
constexpr std::chrono::seconds kDeadline{60};

/// What the camera and the reconstruction agree on.
class FrameClock {
 public:
  void tick(std::uint64_t frames) {
    const std::lock_guard lock(mutex_);
    due_ = std::min(kFrames, due_ + frames);
    changed_.notify_all();
  }
  /// The camera: false when it takes no further frame.
  bool wait_for_tick(std::uint64_t frame) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kDeadline, [&] { return stopped_ || due_ > frame; }) && !stopped_;
  }
  void has_taken(std::uint64_t frame) {
    const std::lock_guard lock(mutex_);
    taken_ = frame + 1;
    changed_.notify_all();
  }
  /// The camera has taken a frame at each tick so far.
  bool wait_for_camera() {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kDeadline, [&] { return taken_ == due_; });
  }
  void stop() {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  /// The number of the newest frame that was due.
  std::uint64_t now() {
    const std::lock_guard lock(mutex_);
    return due_ - 1;
  }
  std::uint64_t taken() {
    const std::lock_guard lock(mutex_);
    return taken_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::uint64_t due_ = 0, taken_ = 0;
  bool stopped_ = false;
};

class TickedSource final : public Source {
 public:
  TickedSource(FrameClock& clock, std::size_t cameras) : clock_(clock), cameras_(small_cameras(cameras)) {}
  ~TickedSource() override { stop(); }
  const std::vector<CameraInfo>& cameras() const noexcept override { return cameras_; }
  void start(FrameSink& sink) override {
    thread_ = std::thread([this, &sink] {
      for (std::uint64_t frame = 0; frame < kFrames && clock_.wait_for_tick(frame); ++frame) {
        for (std::uint32_t camera = 0; camera < cameras_.size(); ++camera) send(sink, camera, frame);
        clock_.has_taken(frame);
      }
      sink.end();
    });
  }
  void stop() noexcept override {
    clock_.stop();
    if (thread_.joinable()) thread_.join();
  }
  std::int64_t nominal_period_ns() const noexcept override { return 0; }
  std::string failure() const override { return {}; }

 private:
  FrameClock& clock_;
  std::vector<CameraInfo> cameras_;
  std::thread thread_;
};

/// Half as fast as the camera. Notes how many frames ago each frame was taken when its result is ready.
class HalfSpeed final : public Reconstructor {
 public:
  /// `lets_camera_wait`: it does not wait for the camera, which waits for it.
  HalfSpeed(FrameClock& clock, bool lets_camera_wait, std::vector<std::uint64_t>& ages)
      : clock_(clock), lets_camera_wait_(lets_camera_wait), ages_(ages) {
    ages_.reserve(kFrames);
  }
  void reconstruct(const FrameSet& frames, Particles& out) noexcept override {
    out.clear();
    clock_.tick(2);
    EXPECT_TRUE(lets_camera_wait_ || clock_.wait_for_camera());
    ages_.push_back(clock_.now() - frames.info().index);
  }

 private:
  FrameClock& clock_;
  const bool lets_camera_wait_;
  std::vector<std::uint64_t>& ages_;
};

struct Outcome {
  std::vector<std::uint64_t> shown, ages;  ///< frames in the order of their results, and how old each was then
  std::vector<std::array<std::uint64_t, kLossCauseCount>> losses;
  std::uint64_t lost(LossCause cause) const { return losses.at(0)[static_cast<std::size_t>(cause)]; }
  std::uint64_t oldest() const { return *std::max_element(ages.begin(), ages.end()); }
};

Outcome overload(const HandOverPolicy& policy, std::size_t cameras) {
  Outcome outcome;
  FrameClock clock;
  const bool lossless = std::holds_alternative<Lossless>(policy);
  PipelineOptions options;
  options.intake.policy = policy;
  Pipeline pipeline(std::make_unique<TickedSource>(clock, cameras),
                    std::make_unique<HalfSpeed>(clock, lossless, outcome.ages), LinkerSettings{}, options);
  pipeline.add_reader([&](ResultLease&& result) { outcome.shown.push_back(result->frame); });
  pipeline.start();
  clock.tick(1);
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  while (!pipeline.finished() && host_now_ns() < deadline_ns) std::this_thread::yield();
  EXPECT_TRUE(pipeline.finished());
  pipeline.stop();
  EXPECT_EQ(clock.taken(), kFrames);
  for (std::uint32_t camera = 0; camera < cameras; ++camera) {
    outcome.losses.push_back(pipeline.camera_losses(camera).snapshot());
    EXPECT_EQ(outcome.shown.size() + pipeline.camera_losses(camera).total(), kFrames) << "nothing is lost uncounted";
  }
  EXPECT_EQ(pipeline.stage_losses().total(), 0U);
  EXPECT_TRUE(std::is_sorted(outcome.shown.begin(), outcome.shown.end()));
  return outcome;
}

TEST(Overload, shows_no_frame_older_than_two_periods_when_newest) {
  const Outcome outcome = overload(Newest{}, 1);
  EXPECT_EQ(outcome.shown.size(), kFrames / 2 + 1);
  EXPECT_EQ(outcome.lost(LossCause::superseded), kFrames / 2 - 1);
  EXPECT_LE(outcome.oldest(), 2U) << "the two that its reconstruction took";
}

TEST(Overload, loses_no_frame_and_holds_the_camera_back_when_lossless) {
  for (const std::size_t cameras : {1U, 3U}) {
    const Outcome outcome = overload(Lossless{kDepth}, cameras);
    std::vector<std::uint64_t> every(kFrames);
    std::iota(every.begin(), every.end(), 0U);
    EXPECT_EQ(outcome.shown, every);
    EXPECT_GT(outcome.oldest(), 100U) << "the camera was held back";
  }
}

TEST(Overload, keeps_no_more_waiting_than_its_depth_when_bounded) {
  const Outcome outcome = overload(Bounded{kDepth}, 1);
  EXPECT_GE(outcome.shown.size(), kFrames / 2);
  EXPECT_GT(outcome.lost(LossCause::over_bound), kFrames / 2 - 2 * kDepth);
  EXPECT_LE(outcome.oldest(), 2 * (kDepth + 1)) << "those that waited before it, and its own reconstruction";
}

TEST(Overload, counts_for_each_camera_what_sets_of_several_lose) {
  EXPECT_EQ(overload(Newest{}, 3).shown.back(), kFrames - 1) << "nothing comes after it that could replace it";
  EXPECT_GE(overload(Bounded{kDepth}, 3).shown.size(), kDepth);
}

}  // namespace
}  // namespace rptv
