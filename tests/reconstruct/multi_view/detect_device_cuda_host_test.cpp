// SPDX-License-Identifier: MIT
// The multi-view stage with the device, run on the CPU, against the stage without; its trial; and devices that fail.
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "reconstruct/detection/detect_cuda.hpp"
#include "reconstruct/detection/detect_trial.hpp"
#include "reconstruct/detection/detector.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"

namespace rptv {
namespace {

constexpr ImageShape kShape{1920, 1200, 1};

MultiViewSettings settings_of_test() {
  MultiViewSettings settings;
  settings.volume_x_mm = settings.volume_y_mm = settings.volume_z_mm = {-110, 110};
  settings.max_particles = 200, settings.max_matches = 4096;
  settings.detector.method = "centroid", settings.detector.max_detections = 300;
  return settings;
}

/// The real device behind a fault.
class FaultyDevice final : public DetectDevice {
 public:
  enum class Fault { fails, fails_later, moves_a_spot, loses_a_spot };
  FaultyDevice(const DetectDevicePlan& plan, Fault fault) : device_(make_detect_cuda(plan)), fault_(fault) {}

  bool detect(std::span<const ImageView> images, std::span<Detections> seen) noexcept override {
    const bool done = device_->detect(images, seen);
    if (fault_ == Fault::moves_a_spot) seen[0].x_px.back() += 1e-12;
    if (fault_ == Fault::loses_a_spot)
      for (auto* column : {&seen[0].x_px, &seen[0].y_px, &seen[0].sigma_px, &seen[0].grey, &seen[0].area_px})
        column->pop_back();
    return done && fault_ != Fault::fails && (fault_ != Fault::fails_later || ++calls_ < 2);
  }

 private:
  std::unique_ptr<DetectDevice> device_;
  Fault fault_;
  int calls_ = 0;
};

class MultiViewOnTheDevice : public ::testing::Test {
 protected:
  MultiViewOnTheDevice() { testing::paint(scene_, frames_); }

  MultiView make(const MakeDetectDevice& make_device) const {
    return MultiView(settings_of_test(), scene_.rig, frames_.views("view", 0), make_device);
  }
  void expect_same(MultiView& a, MultiView& b) {
    Particles of_a(200), of_b(200);
    a.reconstruct(frames_.set(), of_a), b.reconstruct(frames_.set(), of_b);
    EXPECT_GT(of_a.size(), 25U);
    EXPECT_EQ(of_a.x_mm, of_b.x_mm);
    EXPECT_EQ(of_a.y_mm, of_b.y_mm);
    EXPECT_EQ(of_a.z_mm, of_b.z_mm);
    EXPECT_EQ(of_a.support, of_b.support);
    EXPECT_EQ(of_a.covariance_mm2, of_b.covariance_mm2);
    EXPECT_EQ(of_a.ghost, of_b.ghost);
  }

  testing::ViewScene scene_ = testing::make_scene(4, 40, 0);
  testing::CameraFrames frames_{kShape, 4};
};

TEST_F(MultiViewOnTheDevice, finds_the_particles_of_the_cpu_and_allocates_nothing_there) {
  MultiView cpu = make({}), device = make(make_detect_cuda);
  const std::size_t bytes = cuda_host::device_bytes_in_use();
  EXPECT_GT(bytes, 4 * kShape.pixels());
  expect_same(device, cpu);
  frames_.set().frames[2].info.torn = true;  // and without a view
  expect_same(device, cpu);
  EXPECT_EQ(device.counts().refused_views, 1U);
  EXPECT_EQ(cuda_host::device_bytes_in_use(), bytes);
  EXPECT_FALSE(device.counts().device_failed);
  EXPECT_EQ(device.sets_without_device(), 0U);
}

TEST_F(MultiViewOnTheDevice, goes_on_with_the_cpu_where_that_fails_and_counts_it) {
  MultiView cpu = make({});
  MultiView failing = make([](const DetectDevicePlan& plan) {
    return std::make_unique<FaultyDevice>(plan, FaultyDevice::Fault::fails_later);
  });
  expect_same(failing, cpu);
  EXPECT_EQ(failing.sets_without_device(), 0U);
  for (int set = 0; set < 2; ++set) expect_same(failing, cpu);
  EXPECT_TRUE(failing.counts().device_failed);
  EXPECT_EQ(failing.sets_without_device(), 2U);
}

/// Two small cameras, one with a background of each pixel.
struct SmallPlan {
  DetectorSettings settings = settings_of_test().detector;
  std::vector<ImageShape> shapes{{200, 150, 1}, {131, 77, 2}};
  std::vector<std::uint16_t> background = std::vector<std::uint16_t>(131 * 77, 40);
  std::vector<DarkPixels> dark;
  DetectDevicePlan plan;
  SmallPlan() : plan{settings, shapes, {}} {
    background[500] = 90;
    dark.push_back(make_dark(dark_settings(settings, 0), shapes[0], {}));
    dark.push_back(make_dark(dark_settings(settings, 1), shapes[1],
                             {reinterpret_cast<const std::byte*>(background.data()), shapes[1]}));
    plan.dark = dark;
  }
};

TEST(DetectDevice, that_repeats_the_cpu_is_trusted) {
  for (const std::string method : {"three_point", "centroid", "gaussian"}) {
    SmallPlan small;
    small.settings.method = method, small.settings.overlap_sweeps = 0;
    const auto device = make_detect_cuda(small.plan);
    const DeviceTrial trial = try_device(*device, small.plan, 1);
    EXPECT_EQ(trial.differs, "") << method;
    EXPECT_GT(trial.cpu_ms, 0);
    EXPECT_GT(trial.device_ms, 0);
  }
}

TEST(DetectDevice, that_differs_anywhere_or_fails_is_not) {
  using Fault = FaultyDevice::Fault;
  const SmallPlan small;
  for (const auto& [fault, text] :
       {std::pair(Fault::fails, "it fails"), std::pair(Fault::moves_a_spot, "it finds other particle images"),
        std::pair(Fault::loses_a_spot, "it finds other particle images")}) {
    FaultyDevice device(small.plan, fault);
    EXPECT_EQ(try_device(device, small.plan, 1).differs, text);
  }
}

}  // namespace
}  // namespace rptv
