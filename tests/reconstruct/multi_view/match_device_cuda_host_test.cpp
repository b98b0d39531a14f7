// SPDX-License-Identifier: MIT
// The multi-view stage with detection and matching on the device, run on the CPU, against the stage without.
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "reconstruct/detection/detect_cuda.hpp"
#include "reconstruct/multi_view/match_cuda.hpp"
#include "reconstruct/multi_view/match_trial.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "tests/core/same_particles.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"

namespace rptv {
namespace {

constexpr ImageShape kShape{1920, 1200, 1};

MultiViewSettings settings_of_test() {
  MultiViewSettings settings;
  settings.rig = "rig.toml", settings.ghosts = "views";
  settings.volume_x_mm = settings.volume_y_mm = settings.volume_z_mm = {-110, 110};
  settings.max_particles = 600, settings.max_matches = 1200;
  settings.detector.method = "three_point", settings.detector.background = 10;
  settings.detector.max_detections = 400;
  return settings;
}

/// The real one behind a fault.
class FaultyMatcher final : public MatchDevice {
 public:
  enum class Fault { none, fails, fails_later, loses_matches, moves_matches };
  FaultyMatcher(const MatchDevicePlan& plan, Fault fault) : device_(make_match_cuda(plan)), fault_(fault) {}

  bool match(std::span<const Detections> seen, std::span<const ViewMatch>& matches,
             CorrespondenceCounts& counts) noexcept override {
    if (fault_ == Fault::fails || (fault_ == Fault::fails_later && calls_++ > 0)) return false;
    if (!device_->match(seen, matches, counts)) return false;
    if (fault_ == Fault::loses_matches) matches = matches.first(matches.size() * 19 / 20);
    if (fault_ == Fault::moves_matches) {
      moved_.assign(matches.begin(), matches.end());
      for (ViewMatch& match : moved_) match.square_px2 *= 1 + 1e-12;
      matches = moved_;
    }
    return true;
  }
  std::span<const SeenView> views() const noexcept override { return device_->views(); }

 private:
  std::unique_ptr<MatchDevice> device_;
  const Fault fault_;
  int calls_ = 0;
  std::vector<ViewMatch> moved_;
};

using Fault = FaultyMatcher::Fault;

MakeMatchDevice matcher_with(Fault fault) {
  return [fault](const MatchDevicePlan& plan) { return std::make_unique<FaultyMatcher>(plan, fault); };
}

class MatchingOnTheDevice : public ::testing::TestWithParam<bool> {
 protected:
  MatchingOnTheDevice() { testing::paint(scene_, frames_); }
  MultiView make(const MakeDetectDevice& detect, const MakeMatchDevice& match) const {
    return MultiView(settings_of_test(), scene_.rig, frames_.views("view", 0), detect, match);
  }
  /// From the same frame set, which has so many particles at least.
  void expect_same(MultiView& device, MultiView& cpu, std::size_t least) {
    Particles found(600), expected(600);
    device.reconstruct(frames_.set(), found), cpu.reconstruct(frames_.set(), expected);
    EXPECT_GT(expected.size(), least);
    testing::expect_same(found, expected);
    EXPECT_EQ(device.losses().snapshot(), cpu.losses().snapshot());
    EXPECT_EQ(device.correspondence_counts().unusable_detections, cpu.correspondence_counts().unusable_detections);
  }

  testing::ViewScene scene_ = testing::make_scene(4, 80, 0, 0, GetParam());
  testing::CameraFrames frames_{kShape, 4};
};

INSTANTIATE_TEST_SUITE_P(air_and_tank, MatchingOnTheDevice, ::testing::Bool());

TEST_P(MatchingOnTheDevice, finds_the_particles_of_the_cpu_in_the_memory_that_it_has) {
  MultiView cpu = make({}, {}), device = make(make_detect_cuda, make_match_cuda);
  const std::size_t bytes = cuda_host::device_bytes_in_use();
  expect_same(device, cpu, 70);
  frames_.set().frames[2].info.torn = true;  // and without a view
  expect_same(device, cpu, 60);
  EXPECT_EQ(device.counts().refused_views, 1U);
  EXPECT_EQ(cuda_host::device_bytes_in_use(), bytes);
  EXPECT_EQ(device.sets_without_device(), 0U);
}

TEST_P(MatchingOnTheDevice, is_the_cpus_from_the_frame_set_on_where_it_fails) {
  MultiView cpu = make({}, {}), device = make({}, matcher_with(Fault::fails_later));
  const std::size_t bytes = cuda_host::device_bytes_in_use();
  for (int set = 0; set < 3; ++set) expect_same(device, cpu, 70);
  EXPECT_EQ(device.sets_without_device(), 2U);
  EXPECT_TRUE(device.counts().device_failed);
  EXPECT_LT(cuda_host::device_bytes_in_use(), bytes);
}

class MatchTrial : public ::testing::TestWithParam<std::size_t> {
 protected:
  std::string differs(Fault fault) const {
    const testing::ViewScene scene = testing::make_scene(GetParam(), 0, 0);
    const testing::CameraFrames frames({1920, 1200, 1}, static_cast<std::uint32_t>(GetParam()));
    DeviceTrial trial;
    MultiView(settings_of_test(), scene.rig, frames.views("view", 0), {}, [&](const MatchDevicePlan& plan) {
      auto device = std::make_unique<FaultyMatcher>(plan, fault);
      trial = try_device(*device, plan);
      return device;
    });
    EXPECT_EQ(trial.cpu_ms > 0 && trial.device_ms > 0, trial.differs.empty());
    return trial.differs;
  }
};

INSTANTIATE_TEST_SUITE_P(cameras, MatchTrial, ::testing::Values(3, 4, 6));

TEST_P(MatchTrial, trusts_a_device_that_repeats_the_cpu) { EXPECT_EQ(differs(Fault::none), ""); }

TEST_P(MatchTrial, does_not_trust_one_that_differs_or_fails) {
  EXPECT_EQ(differs(Fault::fails), "it fails");
  EXPECT_EQ(differs(Fault::loses_matches), "it finds other particles");
  EXPECT_EQ(differs(Fault::moves_matches), "it finds other particles");
}

}  // namespace
}  // namespace rptv
