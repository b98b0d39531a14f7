// SPDX-License-Identifier: MIT
// A part of the particle tracking challenge's cameras, rendered, on the device: frame sets in two streams at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "calibration/space_algebra.hpp"
#include "reconstruct/detection/detect_stream_cuda.hpp"
#include "reconstruct/detection/detector.hpp"
#include "reconstruct/multi_view/match_stream_cuda.hpp"
#include "simulation/challenge_rig.hpp"
#include "simulation/render_views.hpp"
#include "simulation/tracers.hpp"
#include "tests/cuda_host/control.hpp"

namespace rptv {
namespace {

constexpr std::size_t kCameras = 4, kMost = 600;

ScenarioSettings scenario_of_test(const Rig& rig) {
  ScenarioSettings scenario;
  scenario.views = {"lpt_challenge", 0.1, 0.01, 0.8};
  scenario.flow.kind = "random";
  scenario.seeding.volume_x_mm = 100, scenario.seeding.volume_y_mm = 50, scenario.seeding.volume_z_mm = 30;
  scenario.seeding.photoelectrons = 5000;
  return fitted_to_rig(scenario, rig);
}

std::vector<ViewRays> rays_of(const Rig& rig, const Volume& volume) {
  std::vector<ViewRays> rays;
  for (const RigCamera& camera : rig.cameras) rays.emplace_back(camera.model, volume, camera.name);
  return rays;
}

std::size_t found_of(const std::vector<Tracer>& truth, std::span<const ViewMatch> matches) {
  std::size_t found = 0;
  for (const Tracer& tracer : truth)
    found += std::any_of(matches.begin(), matches.end(), [&](const ViewMatch& match) {
      return norm(match.at_mm - Point3{tracer.position.x, tracer.position.y, tracer.position.z}) < 0.1;
    });
  return found;
}

class ChallengeOnTheDevice : public ::testing::Test {
 protected:
  ChallengeOnTheDevice() {
    settings_.method = "three_point", settings_.background = scenario_.camera.black_level_dn;
    settings_.max_detections = kMost, settings_.radius_px = 1, settings_.min_area_px = 1;
    options_.max_detections = kMost, options_.max_matches = 4 * kMost, options_.tolerance_px = 0.8;
    for (std::size_t c = 0; c < kCameras; ++c) renderers_.emplace_back(scenario_, rig_.cameras[c].model, c);
    shape_ = renderers_[0].shape();
    pixels_.resize(shape_.bytes());
  }

  /// What a camera's frame shows, by the device; the CPU says the same.
  void detect(std::size_t camera, std::uint64_t frame, DetectStream& device, Detections& seen) {
    renderers_[camera].render(tracers_.lit(frame), frame, pixels_);
    device.submit({pixels_.data(), shape_});
    device.collect(seen);
    Detections expected(kMost);
    Detector(settings_, shape_).detect({pixels_.data(), shape_}, expected);
    EXPECT_EQ(device.failed(), 0U) << take_cuda_error() << ": " << cuda_host::last_fault();
    EXPECT_EQ(seen.x_px, expected.x_px);
    EXPECT_EQ(seen.y_px, expected.y_px);
    EXPECT_GT(seen.size(), 100U);
  }

  /// Those that three cameras see at least.
  std::vector<Tracer> visible(std::uint64_t frame) const {
    std::vector<Tracer> visible;
    for (const Tracer& tracer : tracers_.lit(frame))
      if (std::count_if(renderers_.begin(), renderers_.end(),
                        [&](const ViewRenderer& camera) { return camera.view_of(tracer).in_view; }) >= 3)
        visible.push_back(tracer);
    return visible;
  }

  const Rig rig_ = challenge_rig(0.1);
  const ScenarioSettings scenario_ = scenario_of_test(rig_);
  const Tracers tracers_{scenario_};
  DetectorSettings settings_;
  CorrespondenceOptions options_;
  std::deque<ViewRenderer> renderers_;
  ImageShape shape_;
  std::vector<std::byte> pixels_;
};

TEST_F(ChallengeOnTheDevice, finds_nine_in_ten_particles_of_each_frame_set) {
  const Volume volume{{-6, -3.5, -16}, {6, 3.5, 16}};
  const auto rays = rays_of(rig_, volume);
  const MatchRig rig(rays, volume, options_);
  std::deque<MatchStream> streams;
  std::deque<DetectStream> detectors;
  for (int i = 0; i < 2; ++i) streams.emplace_back(rig);
  const DarkPixels dark = make_dark(dark_settings(settings_, 0), shape_, {});
  for (std::size_t c = 0; c < kCameras; ++c) detectors.emplace_back(settings_, shape_, dark);
  const auto check = [&](std::uint64_t frame) {
    const auto truth = visible(frame);
    const auto matches = streams[frame % 2].collect();
    EXPECT_EQ(streams[frame % 2].counts().failed, 0U) << take_cuda_error() << ": " << cuda_host::last_fault();
    EXPECT_GE(found_of(truth, matches), truth.size() * 9 / 10) << "of " << truth.size() << ", frame " << frame;
    EXPECT_GT(truth.size(), 50U);
    EXPECT_LE(matches.size(), truth.size() * 12 / 10);  // some are seen half
  };
  constexpr std::uint64_t kFrames = 4;
  for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
    std::vector<Detections> seen;
    for (std::size_t c = 0; c < kCameras; ++c) detect(c, frame, detectors[c], seen.emplace_back(kMost));
    streams[frame % 2].submit(seen);
    if (frame > 0) check(frame - 1);  // while this one is on its way
  }
  check(kFrames - 1);
}

}  // namespace
}  // namespace rptv
