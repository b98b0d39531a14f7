// SPDX-License-Identifier: MIT
// Every kernel of the multi-view chain once, small, for ThreadSanitizer: CUDA threads that nothing orders must not
// touch the same words.
#include <gtest/gtest.h>

#include <random>

#include "reconstruct/detection/detect_stream_cuda.hpp"
#include "reconstruct/detection/detector.hpp"
#include "reconstruct/multi_view/match_stream_cuda.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

TEST(MultiViewKernels, have_no_races_when_they_match) {
  const testing::ViewScene scene = testing::make_scene(4, 40, 0.3, 0.15);
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options;
  options.tolerance_px = 2, options.max_detections = 45, options.max_matches = 400;  // rivals, and few blocks
  for (const unsigned threads : {96U, 256U}) {
    const MatchRig rig(rays, scene.volume, options, threads);
    MatchStream stream(rig);
    for (const std::uint64_t seed : {0U, 4U}) {
      cuda_host::set_schedule_seed(seed);
      stream.submit(scene.detections);
      EXPECT_GT(stream.collect().size(), 30U);
      EXPECT_EQ(stream.counts().failed, 0U) << cuda_host::last_fault();
    }
  }
}

TEST(MultiViewKernels, have_no_races_when_they_detect) {
  const ImageShape shape{71, 53, 1};
  std::vector<std::byte> grey(shape.pixels());
  std::mt19937 random(1);
  for (std::byte& value : grey) value = static_cast<std::byte>(random() % 256);
  DetectorSettings settings;
  settings.method = "three_point", settings.overlap_sweeps = 0, settings.max_detections = 200;
  const DarkPixels dark = make_dark(dark_settings(settings, 0), shape, {});
  Detections seen(200), expected(200);
  Detector(settings, shape).detect({grey.data(), shape}, expected);
  for (const unsigned threads : {96U, 256U}) {
    cuda_host::set_schedule_seed(threads);
    DetectStream detector(settings, shape, dark, threads);
    detector.submit({grey.data(), shape});
    detector.collect(seen);
    EXPECT_EQ(seen.x_px, expected.x_px);
    EXPECT_EQ(detector.failed(), 0U) << cuda_host::last_fault();
  }
}

}  // namespace
}  // namespace rptv
