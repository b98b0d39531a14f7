// SPDX-License-Identifier: MIT
// Stages of streams, timed by events: which streams are watched, what counts where, and what has no room.
#include <gtest/gtest.h>

#include <vector>

#include "reconstruct/cuda_memory.hpp"
#include "reconstruct/cuda_stage_timer.hpp"
#include "reconstruct/detection/detect_stream_cuda.hpp"
#include "reconstruct/detection/detector.hpp"
#include "reconstruct/multi_view/match_stream_cuda.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv {
namespace {

bool copy(CudaStream& stream, CudaStage stage, const DeviceArray<char>& to, const PinnedArray<char>& from) {
  return stream.stage(stage) && stream.upload(to.data(), from.data(), from.size()) && stream.stage(CudaStage::none) &&
         stream.synchronize();
}

TEST(StageTimer, adds_up_what_its_streams_do_between_start_and_stop) {
  const PinnedArray<char> host(1000);
  const DeviceArray<char> device(1000);
  CudaStream before;
  StageTimer timer;
  CudaStream first, second;
  EXPECT_FALSE(before.watched());
  EXPECT_TRUE(copy(first, CudaStage::upload, device, host));  // not yet
  timer.start();
  EXPECT_TRUE(first.timed());
  EXPECT_TRUE(copy(before, CudaStage::upload, device, host));
  EXPECT_TRUE(copy(first, CudaStage::upload, device, host));
  EXPECT_TRUE(copy(second, CudaStage::upload, device, host));
  EXPECT_TRUE(copy(second, CudaStage::count, device, host));
  second.tell(CudaStage::count, 10, 7);
  StageCosts costs{};
  EXPECT_TRUE(timer.stop(costs));
  EXPECT_FALSE(first.timed());
  EXPECT_EQ(of(costs, CudaStage::upload).bytes, 2000U);
  EXPECT_EQ(of(costs, CudaStage::count).bytes, 1010U);
  EXPECT_EQ(of(costs, CudaStage::count).increments, 7U);
  EXPECT_EQ(of(costs, CudaStage::maxima).bytes, 0U);
  EXPECT_EQ(of(costs, CudaStage::maxima).device_ms, 0);
  EXPECT_GE(of(costs, CudaStage::upload).device_ms, 0);
  timer.start();
  EXPECT_TRUE(timer.stop(costs));
  EXPECT_EQ(of(costs, CudaStage::upload).bytes, 0U);  // forgotten
}

TEST(StageTimer, watches_no_stream_that_is_made_after_it) {
  { const StageTimer timer; }
  EXPECT_FALSE(CudaStream().watched());
}

TEST(StageTimer, says_that_marks_had_no_room) {
  StageTimer timer;
  CudaStream stream;
  StageCosts costs{};
  for (const std::size_t marks : {StageMarks::kMostMarks, StageMarks::kMostMarks + 1}) {
    timer.start();
    for (std::size_t i = 0; i < marks; ++i) EXPECT_TRUE(stream.stage(CudaStage::dlt));
    EXPECT_EQ(timer.stop(costs), marks == StageMarks::kMostMarks);
  }
}

TEST(StageTimer, knows_the_stages_of_frame_sets) {
  const testing::ViewScene scene = testing::make_scene(4, 40, 0);
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options;
  options.max_detections = 60, options.max_matches = 300;
  const MatchRig rig(rays, scene.volume, options);
  StageTimer timer;
  MatchStream stream(rig);
  timer.start();
  stream.submit(scene.detections);
  EXPECT_GT(stream.collect().size(), 20U);
  EXPECT_EQ(stream.counts().failed, 0U) << cuda_host::last_fault();
  StageCosts costs{};
  EXPECT_TRUE(timer.stop(costs));
  for (const CudaStage stage : {CudaStage::upload, CudaStage::cells, CudaStage::pairs, CudaStage::tuples,
                                CudaStage::dlt, CudaStage::ghosts, CudaStage::download})
    EXPECT_GT(of(costs, stage).device_ms, 0) << name_of(stage);
  EXPECT_EQ(of(costs, CudaStage::detection).device_ms, 0);
}

TEST(StageTimer, counts_what_a_detector_reads_and_writes) {
  const ImageShape shape{64, 48, 1};
  std::vector<std::byte> grey(shape.pixels());
  grey[20 * 64 + 20] = grey[20 * 64 + 21] = grey[21 * 64 + 20] = std::byte{200};
  DetectorSettings settings;
  settings.method = "three_point", settings.overlap_sweeps = 0, settings.background = 10;
  StageTimer timer;
  DetectStream detector(settings, shape, make_dark(dark_settings(settings, 0), shape, {}));
  Detections seen(500);
  timer.start();
  detector.submit({grey.data(), shape});
  detector.collect(seen);
  StageCosts costs{};
  EXPECT_TRUE(timer.stop(costs));
  EXPECT_EQ(seen.size(), 1U);
  EXPECT_EQ(of(costs, CudaStage::upload).bytes, shape.bytes());
  EXPECT_EQ(of(costs, CudaStage::detection).bytes, sizeof(CudaSpotCounts) + shape.bytes() + 5 * sizeof(double));
  EXPECT_EQ(of(costs, CudaStage::download).bytes,
            2 * sizeof(std::uint32_t) + sizeof(CudaSpotCounts) + 5 * sizeof(double));
  EXPECT_GT(of(costs, CudaStage::detection).device_ms, 0);
}

}  // namespace
}  // namespace rptv
