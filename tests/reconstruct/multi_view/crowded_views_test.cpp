// SPDX-License-Identifier: MIT
// More than 10^5 particle images in a camera, with the default settings: bounded work, and what is left out is counted.
#include <gtest/gtest.h>

#include <chrono>
#include <iostream>
#include <random>

#include "tests/reconstruct/multi_view/camera_frames.hpp"

namespace rptv {
namespace {

constexpr std::size_t kCrowd = 480 * 300;

/// A dot in every square of 4 px.
void crowd(testing::CameraFrames& frames, std::size_t camera) {
  std::mt19937 random(static_cast<unsigned>(camera));
  std::uniform_int_distribution<int> grey(120, 240);
  frames.fill(camera, 10);
  for (std::size_t y = 1; y < 1200; y += 4)
    for (std::size_t x = 1; x < 1920; x += 4) {
      std::byte* middle = frames.pixels(camera) + y * 1920 + x;
      *middle = static_cast<std::byte>(grey(random));
      for (const std::ptrdiff_t step : {-1920, -1, 1, 1920}) middle[step] = static_cast<std::byte>(90);
    }
}

class CrowdedViews : public ::testing::Test {
 protected:
  CrowdedViews() { testing::paint(scene_, frames_); }

  void reconstruct(const char* what) {
    const auto start = std::chrono::steady_clock::now();
    multi_view_.reconstruct(frames_.set(), found_);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    std::cout << what << ": " << elapsed.count() << " ms, " << found_.size() << " particles";
    for (const Detections& seen : multi_view_.detections()) std::cout << ", " << seen.size();
    std::cout << " particle images; left out:";
    for (const LossCause cause : {LossCause::detection_overflow, LossCause::match_overflow, LossCause::search_cut})
      std::cout << ' ' << name_of(cause) << ' ' << multi_view_.losses().of(cause);
    std::cout << '\n';
    const CorrespondenceCounts& counts = multi_view_.correspondence_counts();
    const auto budget = Correspondence::kWorkPerMatch * static_cast<std::uint64_t>(settings_.max_matches);
    EXPECT_LT(counts.pairs + counts.tuples, 4 * budget);
    EXPECT_LE(found_.size(), static_cast<std::size_t>(settings_.max_particles));
  }
  std::size_t right() const {
    std::size_t right = 0;
    for (const Point3& truth : scene_.particles)
      for (std::size_t i = 0; i < found_.size(); ++i)
        right += norm(Point3{found_.x_mm[i], found_.y_mm[i], found_.z_mm[i]} - truth) < 0.2 ? 1 : 0;
    return right;
  }

  testing::ViewScene scene_ = testing::make_scene(4, 50, 0);
  testing::CameraFrames frames_{{1920, 1200, 1}, 4};
  const MultiViewSettings settings_;
  MultiView multi_view_{settings_, scene_.rig, frames_.views("view", 0)};
  Particles found_{static_cast<std::size_t>(settings_.max_particles)};
};

TEST_F(CrowdedViews, of_one_camera_cost_bounded_work_and_leave_what_the_others_see) {
  reconstruct("50 particles");
  const std::size_t usual = right();
  EXPECT_GE(usual, 48U);
  crowd(frames_, 2);
  reconstruct("and 144 000 particle images in one camera");
  const auto room = static_cast<std::uint64_t>(settings_.detector.max_detections);
  EXPECT_EQ(multi_view_.losses().of(LossCause::detection_overflow), kCrowd - room);
  EXPECT_GE(right(), usual - 10) << "the others fix a particle without it";
}

TEST_F(CrowdedViews, of_all_cameras_cost_bounded_work_and_are_forgotten_with_the_next_frame) {
  for (std::size_t camera = 0; camera < 4; ++camera) crowd(frames_, camera);
  reconstruct("144 000 particle images in each camera");
  const auto room = static_cast<std::uint64_t>(settings_.detector.max_detections);
  EXPECT_EQ(multi_view_.losses().of(LossCause::detection_overflow), 4 * (kCrowd - room));
  EXPECT_GT(multi_view_.losses().of(LossCause::match_overflow) + multi_view_.losses().of(LossCause::search_cut), 0U);
  const std::uint64_t lost = multi_view_.losses().total();
  testing::paint(scene_, frames_);
  reconstruct("50 particles afterwards");
  EXPECT_GE(right(), 48U);
  EXPECT_EQ(multi_view_.losses().total(), lost);
}

}  // namespace
}  // namespace rptv
