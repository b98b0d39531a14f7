// SPDX-License-Identifier: MIT
// From four cameras' images to particles' matches on the device: detectors and matching, frame set after frame set.
#include <gtest/gtest.h>

#include <deque>

#include "core/error.hpp"
#include "reconstruct/detection/detect_stream_cuda.hpp"
#include "reconstruct/detection/detector.hpp"
#include "reconstruct/multi_view/match_stream_cuda.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"

namespace rptv {
namespace {

constexpr ImageShape kShape{1920, 1200, 1};

DetectorSettings settings_of_test() {
  DetectorSettings settings;
  settings.method = "three_point", settings.background = 10, settings.max_detections = 500;
  return settings;
}

DarkPixels dark_of(const DetectorSettings& settings, const ImageShape& shape) {
  return make_dark(dark_settings(settings, 0), shape, {});
}

TEST(FramesOnTheDevice, of_four_cameras_give_the_particles) {
  const testing::ViewScene scene = testing::make_scene(4, 120, 0);
  testing::CameraFrames frames(kShape, 4);
  testing::paint(scene, frames);
  const DetectorSettings settings = settings_of_test();
  const DarkPixels dark = dark_of(settings, kShape);
  std::deque<DetectStream> detectors;
  std::vector<Detections> seen;
  for (std::size_t c = 0; c < 4; ++c) {
    detectors.emplace_back(settings, kShape, dark);
    detectors[c].submit(frames.set().frames[c].view());
  }
  for (std::size_t c = 0; c < 4; ++c) {
    Detector cpu(settings, kShape);
    Detections expected(500);
    cpu.detect(frames.set().frames[c].view(), expected);
    detectors[c].collect(seen.emplace_back(500));
    EXPECT_EQ(detectors[c].failed(), 0U) << take_cuda_error() << ": " << cuda_host::last_fault();
    EXPECT_GT(seen[c].size(), 110U);
    EXPECT_EQ(seen[c].x_px, expected.x_px);
    EXPECT_EQ(seen[c].y_px, expected.y_px);
    EXPECT_EQ(seen[c].sigma_px, expected.sigma_px);
    EXPECT_EQ(detectors[c].counts().merged, cpu.counts().merged);
  }
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options;
  options.max_detections = 500, options.max_matches = 1000;
  const MatchRig rig(rays, scene.volume, options);
  MatchStream stream(rig);
  stream.submit(seen);
  const auto found = stream.collect();
  std::size_t right = 0;
  for (const Point3& truth : scene.particles)
    right += std::any_of(found.begin(), found.end(), [&](const ViewMatch& match) {
      return norm(match.at_mm + scene.volume.centre() - truth) < 0.1;
    });
  EXPECT_GE(right, 116U);
  EXPECT_LE(found.size(), 124U);
}

TEST(DetectStream, refuses_images_of_another_shape_and_goes_on) {
  const ImageShape shape{64, 48, 1};
  const DetectorSettings settings = settings_of_test();
  DetectStream detector(settings, shape, dark_of(settings, shape));
  std::vector<std::byte> pixels(64 * 48);
  pixels[20 * 64 + 20] = pixels[20 * 64 + 21] = pixels[21 * 64 + 20] = std::byte{200};
  Detections seen(500);
  detector.submit({pixels.data(), {48, 64, 1}});
  detector.collect(seen);
  EXPECT_EQ(detector.counts().refused_frames, 1U);
  detector.submit({pixels.data(), shape});
  detector.collect(seen);
  EXPECT_EQ(seen.size(), 1U);
  detector.collect(seen);  // nothing was submitted
  EXPECT_EQ(seen.size(), 0U);
  EXPECT_EQ(detector.counts().frames, 1U);
}

TEST(DetectStream, takes_the_image_before_it_returns) {
  const ImageShape shape{64, 48, 2};
  const DetectorSettings settings = settings_of_test();
  DetectStream detector(settings, shape, dark_of(settings, shape));
  std::vector<std::uint16_t> pixels(64 * 48);
  pixels[20 * 64 + 20] = 900, pixels[20 * 64 + 21] = pixels[21 * 64 + 20] = 400;
  detector.submit({reinterpret_cast<const std::byte*>(pixels.data()), shape});
  std::fill(pixels.begin(), pixels.end(), std::uint16_t{0});
  Detections seen(500);
  detector.collect(seen);
  EXPECT_EQ(seen.size(), 1U);
}

TEST(DetectStream, says_which_settings_only_the_cpu_has) {
  DetectorSettings blob = settings_of_test(), sweeps = settings_of_test(), learns = settings_of_test();
  blob.method = "blob", sweeps.method = "gaussian", learns.running_background = true;
  for (const auto& [settings, text] : {std::pair(blob, "method = \"blob\""), std::pair(sweeps, "overlap_sweeps = 6"),
                                       std::pair(learns, "running_background = true")})
    try {
      DetectStream(settings, kShape, dark_of(settings, kShape));
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::unavailable);
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace rptv
