// SPDX-License-Identifier: MIT
// Iterative reconstruction of dense frame sets of the tracking challenge's rig: what it finds, counts and refuses.
#include "reconstruct/multi_view/iterative_views.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/error.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "reconstruct/multi_view/residual_peaks.hpp"
#include "tests/bench/lpt_scene.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/multi_view/painted_views.hpp"

namespace rptv {
namespace {

using bench::LptScene;

constexpr double kPart = 0.2;  // 384 x 240 px

class DenseScene : public ::testing::Test {
 protected:
  DetectionScore find(FrameSet& frames) {
    stage_.reconstruct(frames, found_);
    return scene_.judge(found_);
  }

  LptScene scene_{0.04, kPart};  // 3686 particles
  MultiViewSettings settings_ = scene_.settings();
  IterativeViews stage_{settings_, scene_.rig(), scene_.cameras()};
  Particles found_{static_cast<std::size_t>(settings_.max_particles)};
};

TEST_F(DenseScene, is_found_where_one_look_at_each_image_loses_most) {
  FrameSet& frames = scene_.frames(0);
  const DetectionScore score = find(frames);
  EXPECT_GT(score.recall, 0.98);
  EXPECT_GT(score.precision, 0.995);
  EXPECT_LT(score.rms_mm * scene_.px_per_mm(), 0.1);
  EXPECT_EQ(stage_.counts().frames, 1U);
  EXPECT_EQ(stage_.counts().found - stage_.counts().dropped, found_.size());

  MultiView once(settings_, scene_.rig(), scene_.cameras());
  once.reconstruct(frames, found_);
  EXPECT_LT(scene_.judge(found_).recall, 0.7);
}

TEST_F(DenseScene, is_found_at_once_where_tracks_are_expected) {
  stage_.reconstruct(scene_.frames(0), found_);
  EXPECT_TRUE(stage_.uses_tracks());
  const std::uint64_t before = stage_.counts().found;
  FrameSet& frames = scene_.frames(1);
  std::mt19937 random(3);
  std::normal_distribution<double> error(0, 0.01);
  Tracks expected(2 * scene_.truth().size());
  for (const TruthRow& row : scene_.truth())
    expected.push({row.particle, row.x_mm + error(random), row.y_mm + error(random), row.z_mm + error(random), 0, 0, 0,
                   0, 1 + static_cast<std::uint32_t>(row.age)});
  expected.push({1U << 30, 0, 0, 0, 0, 0, 0, 0, 0});  // has no velocity yet
  stage_.expect(expected);
  const DetectionScore score = find(frames);
  EXPECT_EQ(stage_.counts().expected, scene_.truth().size());
  EXPECT_LT(stage_.counts().found - before, scene_.truth().size() / 20);
  EXPECT_GT(score.recall, 0.995);
  EXPECT_GT(score.precision, 0.995);
  stage_.reconstruct(frames, found_);
  EXPECT_EQ(stage_.counts().expected, scene_.truth().size());  // they count for one frame set
}

struct Onlooker final : ViewObserver {
  bool wanting = true;
  std::vector<std::size_t> seen;
  bool wants() noexcept override { return wanting; }
  void see(std::span<const Detections> views) noexcept override {
    seen.clear();
    for (const Detections& view : views) seen.push_back(view.size());
  }
};

TEST(IterativeViews, shows_whole_images_to_those_who_want_them_and_finds_the_same) {
  LptScene scene(0.02, 0.1);
  FrameSet& frames = scene.frames(0);
  IterativeViews alone(scene.settings(), scene.rig(), scene.cameras());
  IterativeViews watched(scene.settings(), scene.rig(), scene.cameras());
  Particles found(2 * scene.truth().size()), seen_found(2 * scene.truth().size());
  Onlooker onlooker;
  watched.show_to(&onlooker);
  alone.reconstruct(frames, found);
  watched.reconstruct(frames, seen_found);
  EXPECT_EQ(seen_found.x_mm, found.x_mm);
  ASSERT_EQ(onlooker.seen.size(), 4U);
  const auto at_first = onlooker.seen;
  Tracks expected(found.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    expected.push({i, found.x_mm[i], found.y_mm[i], found.z_mm[i], 0, 0, 0, 0, 1});
  watched.expect(expected);
  watched.reconstruct(frames, found);
  for (std::size_t c = 0; c < 4; ++c) {
    EXPECT_GT(at_first[c], scene.truth().size() / 2) << "overlaps leave fewer maxima than particles";
    EXPECT_GT(onlooker.seen[c], at_first[c] * 9 / 10) << "although tracks explain most of them";
    EXPECT_LT(onlooker.seen[c], at_first[c] * 11 / 10);
  }
  onlooker.wanting = false;
  onlooker.seen.clear();
  watched.reconstruct(frames, found);
  EXPECT_TRUE(onlooker.seen.empty());
}

TEST_F(DenseScene, costs_no_allocation_after_the_first_frame) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer's allocator is not counted";
  stage_.reconstruct(scene_.frames(0), found_);
  FrameSet& frames = scene_.frames(1);
  Tracks expected(found_.size());
  for (std::size_t i = 0; i < found_.size(); ++i)
    expected.push({i, found_.x_mm[i], found_.y_mm[i], found_.z_mm[i], 0, 0, 0, 0, 1});
  AllocationCounter counter;
  stage_.expect(expected);
  stage_.reconstruct(frames, found_);
  EXPECT_EQ(counter.disarm(), 0U);
}

TEST_F(DenseScene, goes_on_without_a_view_that_is_missing_and_counts_it) {
  FrameSet& frames = scene_.frames(0);
  frames.frames[1].info.torn = true;
  stage_.reconstruct(frames, found_);
  EXPECT_EQ(stage_.counts().refused_views, 1U);
  EXPECT_GT(found_.size(), 100U);
  for (const double support : found_.support) EXPECT_LE(support, 3);
  frames.frames[2].info.torn = true;
  stage_.reconstruct(frames, found_);
  EXPECT_EQ(stage_.counts().too_few_views, 1U);
  EXPECT_EQ(found_.size(), 0U);
  frames.cameras = 3;
  stage_.reconstruct(frames, found_);
  EXPECT_EQ(stage_.counts().refused_frames, 1U);
  frames.cameras = 4;
}

TEST_F(DenseScene, that_exceeds_the_capacities_is_cut_and_counted) {
  settings_.max_particles = 500, settings_.detector.max_detections = 1000;
  IterativeViews small(settings_, scene_.rig(), scene_.cameras());
  small.reconstruct(scene_.frames(0), found_);
  EXPECT_LE(found_.size(), 500U);
  EXPECT_GT(small.counts().refused_peaks, 0U);
  EXPECT_GT(small.counts().refused_places, 0U);
}

TEST_F(DenseScene, of_empty_images_has_no_particles) {
  FrameSet& frames = scene_.frames(0);
  for (std::size_t c = 0; c < 4; ++c) std::memset(frames.frames[c].lease.get(), 4, frames.frames[c].shape.bytes());
  stage_.reconstruct(frames, found_);
  EXPECT_EQ(found_.size(), 0U);
}

TEST_F(DenseScene, cannot_have_a_running_background_and_says_so) {
  settings_.detector.running_background = true;
  try {
    const IterativeViews refused(settings_, scene_.rig(), scene_.cameras());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    EXPECT_STREQ(error.what(),
                 "multi_view.detector.running_background = true, but multi_view.method = 'iterative' has none; give "
                 "multi_view.detector.background or background_images");
  }
}

TEST(ResidualPeaks, are_where_lone_particles_are_and_as_bright) {
  constexpr auto kSigma_px = static_cast<float>(testing::kSmallSigma_px);
  const auto places = testing::random_places(12, 2);
  ShakenParticles painted = testing::painted_particles(places, 4000, 0);
  const ResidualView& view = painted.views().front();
  Detections peaks(100);
  find_peaks(view, {20, 6}, kSigma_px, peaks);
  EXPECT_EQ(peaks.size(), places.size());
  for (const Point3& place : places) {
    const Pixel pixel = *testing::small_rig().front().project(place);
    std::size_t near = 0;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
      if (std::hypot(peaks.x_px[i] - pixel[0], peaks.y_px[i] - pixel[1]) > 0.1) continue;
      ++near;
      EXPECT_NEAR(peaks.grey[i], 4000, 250);
    }
    EXPECT_EQ(near, 1U);
  }
  std::vector<float> scratch(100);
  EXPECT_NEAR(typical_sigma_px(view, {20, 6}, scratch, 1), kSigma_px, 0.05);
  EXPECT_EQ(typical_sigma_px(view, {1e6F, 6}, scratch, 1), 1);
  Detections few(5);
  find_peaks(view, {20, 6}, kSigma_px, few);
  EXPECT_EQ(few.overflow(), peaks.size() - 5);
}

}  // namespace
}  // namespace rptv
