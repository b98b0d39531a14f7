// SPDX-License-Identifier: MIT
// Every kernel of the multi-view chain once, small, for ThreadSanitizer: CUDA threads that nothing orders must not
// touch the same words.
#include <gtest/gtest.h>

#include <random>

#include "reconstruct/detection/lit_maxima.hpp"
#include "reconstruct/detection/lit_maxima_cuda.hpp"
#include "reconstruct/multi_view/match_stream_cuda.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"
#include "tests/reconstruct/on_device.hpp"

namespace rptv {
namespace {

using testing::OnDevice;

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

TEST(MultiViewKernels, have_no_races_when_they_search_an_image) {
  const ImageShape shape{71, 53, 1};
  std::vector<std::uint8_t> grey(shape.pixels());
  std::mt19937 random(1);
  for (std::uint8_t& value : grey) value = static_cast<std::uint8_t>(random() % 256);
  const DarkLimit limit(shape, 0, 60);
  std::vector<PixelIndex> expected(shape.pixels());
  const std::size_t all = find_lit_maxima({reinterpret_cast<const std::byte*>(grey.data()), shape}, limit, expected);
  for (const unsigned threads : {96U, 256U}) {
    cuda_host::set_schedule_seed(threads);
    const OnDevice<std::uint8_t> pixels(grey);
    const OnDevice<std::uint16_t> dark({60});
    const std::vector<std::int32_t> room(1000);
    const OnDevice<std::int32_t> x(room), y(room);
    const OnDevice<std::uint32_t> row_start(std::vector<std::uint32_t>(shape.height_px + 1));
    CudaStream stream;
    EXPECT_TRUE(find_lit_maxima_cuda({pixels.data(), shape.width_px, shape.height_px, 1}, {nullptr, dark.data(), true},
                                     {x.data(), y.data(), row_start.data(), 1000}, stream.handle(), threads));
    EXPECT_EQ(row_start.read(stream).back(), all);
  }
}

}  // namespace
}  // namespace rptv
