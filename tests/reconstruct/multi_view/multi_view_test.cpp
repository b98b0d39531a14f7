// SPDX-License-Identifier: MIT
// The multi-view stage on painted images: particles, what is missing, what is too much, and settings that do not fit.
#include "reconstruct/multi_view/multi_view.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

using testing::CameraFrames;
using testing::ViewScene;

constexpr ImageShape kShape{1920, 1200, 1};

MultiViewSettings settings_of_test() {
  MultiViewSettings settings;
  settings.rig = "rig.toml";
  settings.volume_x_mm = settings.volume_y_mm = settings.volume_z_mm = {-110, 110};
  settings.max_particles = 200, settings.max_matches = 4096;
  settings.detector.max_detections = 2048;
  return settings;
}

class MultiViewOfPaintedImages : public ::testing::Test {
 protected:
  MultiViewOfPaintedImages() {
    testing::paint(scene_, frames_);
    multi_view_.reconstruct(frames_.set(), found_);
  }
  std::size_t right() const {
    std::size_t right = 0;
    for (const Point3& truth : scene_.particles)
      for (std::size_t i = 0; i < found_.size(); ++i)
        right += norm(Point3{found_.x_mm[i], found_.y_mm[i], found_.z_mm[i]} - truth) < 0.1 ? 1 : 0;
    return right;
  }

  ViewScene scene_ = testing::make_scene(4, 50, 0);
  CameraFrames frames_{kShape, 4};
  MultiView multi_view_{settings_of_test(), scene_.rig, frames_.views("view", 0)};
  Particles found_{200};
};

TEST_F(MultiViewOfPaintedImages, finds_the_particles_in_order_of_support) {
  EXPECT_GE(right(), 48U);
  EXPECT_LE(found_.size(), 51U);
  EXPECT_TRUE(std::is_sorted(found_.support.rbegin(), found_.support.rend()));
  EXPECT_EQ(multi_view_.counts().frames, 1U);
  EXPECT_LT(*std::max_element(found_.ghost.begin(), found_.ghost.end()), 0.5);
}

TEST_F(MultiViewOfPaintedImages, allocates_nothing_after_the_first_frame) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer's allocator is not counted";
  AllocationCounter counter;
  multi_view_.reconstruct(frames_.set(), found_);
  EXPECT_EQ(counter.disarm(), 0U);
  EXPECT_GE(right(), 48U);
}

TEST_F(MultiViewOfPaintedImages, goes_on_without_a_view_that_is_missing_and_counts_it) {
  frames_.set().frames[2].info.torn = true;
  multi_view_.reconstruct(frames_.set(), found_);
  EXPECT_EQ(multi_view_.counts().refused_views, 1U);
  EXPECT_GE(right(), 40U);
  for (const double support : found_.support) EXPECT_EQ(support, 3);

  frames_.set().frames[0].shape.width_px = 1280;
  multi_view_.reconstruct(frames_.set(), found_);
  EXPECT_EQ(found_.size(), 0U);
  EXPECT_EQ(multi_view_.counts().refused_views, 3U);
  EXPECT_EQ(multi_view_.counts().too_few_views, 1U);
  EXPECT_EQ(multi_view_.losses().of(LossCause::view_refused), 3U);
  EXPECT_EQ(multi_view_.losses().of(LossCause::too_few_views), 1U);
  EXPECT_EQ(multi_view_.losses().total(), 4U);
}

TEST_F(MultiViewOfPaintedImages, counts_a_set_of_another_number_of_cameras) {
  frames_.set().cameras = 3;
  multi_view_.reconstruct(frames_.set(), found_);
  frames_.set().cameras = 4;
  EXPECT_EQ(found_.size(), 0U);
  EXPECT_EQ(multi_view_.counts().refused_frames, 1U);
  EXPECT_EQ(multi_view_.losses().of(LossCause::frame_refused), 1U);
}

TEST_F(MultiViewOfPaintedImages, finds_nothing_in_empty_or_saturated_images) {
  for (const int grey : {0, 255}) {
    for (std::size_t c = 0; c < 4; ++c) frames_.fill(c, grey);
    multi_view_.reconstruct(frames_.set(), found_);
    EXPECT_EQ(found_.size(), 0U) << grey;
  }
}

TEST_F(MultiViewOfPaintedImages, cuts_and_counts_what_its_capacity_does_not_hold) {
  Particles few(10);
  multi_view_.reconstruct(frames_.set(), few);
  EXPECT_EQ(few.size(), 10U);
  EXPECT_EQ(multi_view_.counts().refused_particles, few.overflow());
  EXPECT_GT(few.overflow(), 30U);
}

TEST_F(MultiViewOfPaintedImages, tells_by_cause_what_there_was_no_room_for) {
  EXPECT_EQ(multi_view_.losses().total(), 0U);
  MultiViewSettings settings = settings_of_test();
  settings.detector.max_detections = 20, settings.max_matches = 5;
  MultiView small(settings, scene_.rig, frames_.views("view", 0));
  for (int frame = 1; frame <= 2; ++frame) {
    small.reconstruct(frames_.set(), found_);
    EXPECT_EQ(small.losses().of(LossCause::detection_overflow), small.counts().refused_detections);
    EXPECT_EQ(small.losses().of(LossCause::match_overflow), small.correspondence_counts().refused_matches);
    EXPECT_EQ(small.losses().of(LossCause::search_cut), small.correspondence_counts().unsearched);
    EXPECT_GT(small.losses().of(LossCause::detection_overflow), 100U * static_cast<unsigned>(frame));
  }
  EXPECT_GT(small.losses().of(LossCause::match_overflow) + small.losses().of(LossCause::search_cut), 0U);
  EXPECT_EQ(small.losses().of(LossCause::particle_overflow), 0U) << "counted by who gave the room";
}

std::string refusal(const MultiViewSettings& settings, const Rig& rig, std::span<const MultiViewCamera> cameras) {
  try {
    const MultiView multi_view(settings, rig, cameras);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    return error.what();
  }
  return "no error";
}

TEST(MultiViewSetUp, refuses_what_does_not_fit_with_a_line_that_says_so) {
  const Rig rig = testing::make_rig(4);
  std::vector<MultiViewCamera> cameras;
  for (int c = 0; c < 4; ++c) cameras.push_back({"view" + std::to_string(c), kShape, {}});
  const MultiViewSettings good = settings_of_test();
  EXPECT_EQ(refusal(good, rig, cameras), "no error");

  EXPECT_EQ(refusal(good, rig, std::span(cameras).first(2)),
            "multi_view.min_views = 3 and the source has 2 cameras; add cameras, or lower it");
  auto bad = cameras;
  bad[1].name = "cam1";
  EXPECT_EQ(
      refusal(good, rig, bad),
      "rig.toml: has no camera 'cam1' (it has 'view0', 'view1', 'view2', 'view3'); name its cameras as the source "
      "does");
  bad = cameras;
  bad[3].shape.width_px = 1280;
  EXPECT_NE(refusal(good, rig, bad).find("rig.toml"), std::string::npos);
  EXPECT_NE(refusal(good, rig, bad).find("1280"), std::string::npos);
  MultiViewSettings reversed = good;
  reversed.volume_y_mm = {10, -10};
  EXPECT_EQ(refusal(reversed, rig, cameras),
            "multi_view.volume_y_mm is not [from, to] with from < to; correct it, or leave it empty");
}

TEST(MultiViewSetUp, finds_the_volume_that_enough_cameras_see) {
  MultiViewSettings settings = settings_of_test();
  settings.volume_x_mm.clear(), settings.volume_y_mm.clear(), settings.volume_z_mm.clear();
  const Rig rig = testing::make_rig(4);
  std::vector<MultiViewCamera> cameras;
  for (int c = 0; c < 4; ++c) cameras.push_back({"view" + std::to_string(c), kShape, {}});
  const Volume volume = MultiView(settings, rig, cameras).volume();
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(volume.from[k], -90);
    EXPECT_GT(volume.to[k], 90);
    EXPECT_LT(volume.to[k] - volume.from[k], 1500);
  }
}

}  // namespace
}  // namespace rptv
