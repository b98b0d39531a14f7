// SPDX-License-Identifier: MIT
// The whole pipeline over real images: nothing is lost uncounted, replay repeats itself, and frames cost no allocation.
#include "daemon/pipeline.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <numeric>
#include <optional>
#include <utility>

#include "daemon/session.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/daemon/small_run.hpp"

namespace rptv {
namespace {

using testing::SmallRun;

const SmallRun& recording() {
  static const SmallRun run;
  return run;
}

PipelineOptions options_of(const Config& config) {
  PipelineOptions options;
  options.intake = config.intake.options();
  options.max_particles = static_cast<std::size_t>(config.light_field.max_particles);
  return options;
}

std::unique_ptr<Pipeline> make_pipeline(const Config& config) {
  auto source = make_source(config);
  auto reconstructor = make_reconstructor(config, source->cameras());
  return std::make_unique<Pipeline>(std::move(source), std::move(reconstructor), config.linker, options_of(config));
}

void wait_until_finished(const Pipeline& pipeline) {
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  while (!pipeline.finished() && host_now_ns() < deadline_ns) std::this_thread::yield();
  ASSERT_TRUE(pipeline.finished());
}

std::uint64_t lost(const Pipeline& pipeline) {
  const auto losses = pipeline.losses();
  return std::accumulate(losses.begin(), losses.end(), std::uint64_t{0});
}

TEST(Pipeline, links_every_frame_of_a_lossless_replay) {
  const auto pipeline = make_pipeline(recording().config());
  std::uint64_t expected = 0, results = 0;
  pipeline->add_reader([&](ResultLease&& result) {
    ++results;
    EXPECT_EQ(result->frame, expected++);
    EXPECT_GT(result->particles.size(), 0U);
    EXPECT_EQ(result->tracks.size(), result->particles.size());
    for (std::size_t s = 1; s <= static_cast<std::size_t>(Stage::linked); ++s)
      EXPECT_GE(result->stamps.at_ns[s], result->stamps.at_ns[s - 1]) << name_of(static_cast<Stage>(s));
  });
  pipeline->start();
  wait_until_finished(*pipeline);
  pipeline->stop();
  EXPECT_EQ(results, 40U);
  EXPECT_EQ(lost(*pipeline), 0U);
  EXPECT_TRUE(pipeline->idle());
}

TEST(Pipeline, gives_bit_identical_tracks_when_a_recording_is_replayed) {
  std::vector<double> numbers[2];
  for (auto& values : numbers) {
    const auto pipeline = make_pipeline(recording().config());
    pipeline->add_reader([&values](ResultLease&& result) {
      const Tracks& t = result->tracks;
      for (std::size_t i = 0; i < t.size(); ++i)
        values.insert(values.end(), {static_cast<double>(t.particle[i]), t.x_mm[i], t.y_mm[i], t.z_mm[i], t.vx_mm_s[i],
                                     t.vy_mm_s[i], t.vz_mm_s[i], t.residual_mm[i]});
    });
    pipeline->start();
    wait_until_finished(*pipeline);
    pipeline->stop();
  }
  ASSERT_GT(numbers[0].size(), 1000U);
  EXPECT_EQ(numbers[0], numbers[1]);
}

TEST(Pipeline, counts_by_cause_what_a_faulty_recording_loses) {
  Config config = recording().config();
  config.replay.faults.drop_fraction = 0.1;
  config.replay.faults.duplicate_fraction = 0.1;
  config.replay.faults.torn_fraction = 0.1;
  config.replay.loop = 5;
  const auto pipeline = make_pipeline(config);
  pipeline->start();
  wait_until_finished(*pipeline);
  pipeline->stop();
  const PipelineCounts counts = pipeline->counts();
  const Losses& losses = pipeline->camera_losses(0);
  EXPECT_GT(losses.of(LossCause::source_gap), 0U);
  EXPECT_GT(losses.of(LossCause::source_duplicate), 0U);
  EXPECT_GT(losses.of(LossCause::source_torn), 0U);
  EXPECT_EQ(counts.linked + losses.of(LossCause::source_duplicate) + losses.of(LossCause::source_torn), counts.arrived);
  EXPECT_EQ(counts.linked + losses.of(LossCause::source_gap) + losses.of(LossCause::source_torn), 200U);
}

/// Holds each frame until the test lets it go: the consumer that is too slow.
class GatedReconstructor final : public Reconstructor {
 public:
  void reconstruct(const FrameSet&, Particles& out) noexcept override {
    out.clear();
    std::unique_lock lock(mutex_);
    ++entered_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
  }
  void wait_for_first() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return entered_ > 0; });
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  int entered_ = 0;
};

class SlowConsumer : public ::testing::TestWithParam<const char*> {};

TEST_P(SlowConsumer, loses_by_policy_and_counts_every_frame) {
  Config config = recording().config();
  config.intake.policy = GetParam();
  config.intake.depth = 4;
  config.replay.preload = true;
  auto source = make_source(config);
  auto gate_owner = std::make_unique<GatedReconstructor>();
  GatedReconstructor& gate = *gate_owner;
  Pipeline pipeline(std::move(source), std::move(gate_owner), config.linker, options_of(config));
  std::vector<std::uint64_t> frames;
  pipeline.add_reader([&frames](ResultLease&& result) { frames.push_back(result->frame); });
  pipeline.start();
  gate.wait_for_first();
  const bool waits = config.intake.policy == "lossless";
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  while (!waits && pipeline.counts().arrived < 40 && host_now_ns() < deadline_ns) std::this_thread::yield();
  gate.open();
  wait_until_finished(pipeline);
  pipeline.stop();
  EXPECT_EQ(pipeline.counts().linked + lost(pipeline), 40U);
  if (waits) {
    EXPECT_EQ(lost(pipeline), 0U);
  } else if (config.intake.policy == "newest") {
    EXPECT_EQ(frames.back(), 39U);
    EXPECT_LE(frames.size(), 3U);
    EXPECT_GT(pipeline.camera_losses(0).of(LossCause::superseded), 30U);
  } else {
    EXPECT_LE(frames.size(), 6U);
    EXPECT_GT(pipeline.camera_losses(0).of(LossCause::over_bound), 30U);
  }
}

INSTANTIATE_TEST_SUITE_P(Policies, SlowConsumer, ::testing::Values("newest", "lossless", "bounded"));

/// The real reconstruction, which also asks for the tracks that are expected, and notes how many there were.
class ExpectingReconstructor final : public Reconstructor {
 public:
  explicit ExpectingReconstructor(std::unique_ptr<Reconstructor> real) : real_(std::move(real)) {}
  bool uses_tracks() const noexcept override { return true; }
  void expect(const Tracks& expected) noexcept override {
    told_ = true;
    expected_ = expected.size();
  }
  void reconstruct(const FrameSet& frames, Particles& out) noexcept override {
    EXPECT_TRUE(std::exchange(told_, false));
    real_->reconstruct(frames, out);
    EXPECT_GE(expected_, last_particles_);  // all that the linker had of the frame before, and remembered ones
    last_particles_ = out.size();
  }

 private:
  std::unique_ptr<Reconstructor> real_;
  bool told_ = false;
  std::size_t expected_ = 0, last_particles_ = 0;
};

std::vector<double> track_columns(Pipeline& pipeline) {
  std::vector<double> columns;
  pipeline.add_reader([&](ResultLease&& result) {
    for (std::size_t i = 0; i < result->tracks.size(); ++i) {
      columns.push_back(static_cast<double>(result->tracks.particle[i]));
      columns.push_back(result->tracks.x_mm[i]), columns.push_back(result->tracks.vz_mm_s[i]);
    }
  });
  pipeline.start();
  wait_until_finished(pipeline);
  pipeline.stop();
  return columns;
}

TEST(Pipeline, takes_turns_with_the_linker_where_tracks_are_expected_and_links_the_same) {
  const Config config = recording().config();
  auto source = make_source(config);
  auto expecting = std::make_unique<ExpectingReconstructor>(make_reconstructor(config, source->cameras()));
  Pipeline in_turns(std::move(source), std::move(expecting), config.linker, options_of(config));
  const auto columns = track_columns(in_turns);
  EXPECT_GT(columns.size(), 100U);
  EXPECT_EQ(columns, track_columns(*make_pipeline(config)));
}

TEST(Pipeline, allocates_nothing_for_a_frame_once_it_runs) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer owns the allocator";
  Config config = recording().config();
  config.replay.preload = true;
  config.replay.loop = 6;
  config.light_field.threads = 2;
  const auto pipeline = make_pipeline(config);
  std::uint64_t results = 0, allocations = 1;
  std::optional<AllocationCounter> counter;
  pipeline->add_reader([&](ResultLease&& result) {
    ++results;
    if (result->frame == 80) counter.emplace();
    if (result->frame == 220) allocations = counter->disarm();
  });
  pipeline->start();
  wait_until_finished(*pipeline);
  pipeline->stop();
  EXPECT_EQ(results, 240U);
  EXPECT_EQ(allocations, 0U);
}

}  // namespace
}  // namespace rptv
