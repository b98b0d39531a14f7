// SPDX-License-Identifier: MIT
// The drift monitor names the camera that was pushed and no other, and nobody waits for it.
#include "daemon/drift_monitor.hpp"

#include <gmock/gmock.h>

#include <atomic>

#include "tests/core/allocation_counter.hpp"
#include "tests/daemon/pushed_rig.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::ViewScene;

const Volume kVolume{{-100, -100, -100}, {100, 100, 100}};
constexpr std::int64_t kDeadlineNs = 300'000'000'000;

DriftOptions options_of_test(double window_s) {
  return {.window_s = window_s, .alarm_px = 0.5, .most_detections = 1024, .rig_file = "rig.toml"};
}

/// What it says of particles seen by the cameras of make_rig(), once it has looked `looks` times.
StatusReport watch(const Rig& calibrated, std::size_t looks) {
  std::vector<ViewScene> scenes;
  for (unsigned seed = 1; seed <= 8; ++seed)
    scenes.push_back(testing::make_scene(calibrated.cameras.size(), 400, 0.1, 0.05, false, seed));
  DriftMonitor monitor(calibrated, trace_views(calibrated, kVolume), kVolume, options_of_test(0.1));
  StatusReport status;
  const std::int64_t deadline_ns = host_now_ns() + kDeadlineNs;
  for (std::size_t i = 0; status.drift.looked_at < looks * DriftMonitor::kFramesALook; ++i) {
    monitor.see(scenes[i % scenes.size()].detections);
    status.clear();
    monitor.tell(status);
    if (host_now_ns() > deadline_ns) break;
  }
  EXPECT_GE(status.drift.looked_at, looks * DriftMonitor::kFramesALook);
  return status;
}

class DriftOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(DriftOf, one_camera_raises_the_alarm_for_it_and_no_other) {
  const Rig truth = testing::make_rig(4);
  const StatusReport status = watch(testing::push_camera(truth, GetParam()), 1);
  ASSERT_EQ(status.warnings.size(), 1U);
  const std::string& line = status.warnings.front();
  for (std::size_t c = 0; c < 4; ++c) {
    const std::string name = "'" + truth.cameras[c].name + "'";
    if (c == GetParam())
      EXPECT_THAT(line, HasSubstr("camera " + name + " sees particles "));
    else
      EXPECT_THAT(line, Not(HasSubstr(name)));
  }
  EXPECT_THAT(line, HasSubstr("`rapidptv calibrate refine FRAMES --start rig.toml"));
}

INSTANTIATE_TEST_SUITE_P(Cameras, DriftOf, ::testing::Values(0U, 1U, 2U, 3U));

TEST(DriftMonitor, says_that_it_may_be_another_of_three_cameras) {
  const StatusReport status = watch(testing::push_camera(testing::make_rig(3), 1), 1);
  ASSERT_EQ(status.warnings.size(), 1U);
  EXPECT_THAT(status.warnings.front(),
              HasSubstr(" px from where rig.toml says: it or another of the three has drifted;"));
}

TEST(DriftMonitor, is_silent_while_cameras_stay) {
  const StatusReport status = watch(testing::make_rig(4), 2);
  EXPECT_THAT(status.warnings, ::testing::IsEmpty());
  ASSERT_EQ(status.drift.cameras.size(), 4U);
  for (const DisparityReport& camera : status.drift.cameras) {
    EXPECT_EQ(camera.parts, 8U) << camera.camera;
    EXPECT_GT(camera.votes, 400) << camera.camera;
    EXPECT_LT(camera.median_px, 0.1) << camera.camera;
    EXPECT_LT(camera.worst_px, 0.2) << camera.camera;
  }
}

TEST(DriftMonitor, names_a_camera_that_sees_nothing_until_it_sees_again) {
  ViewScene scene = testing::make_scene(4, 400, 0.1), dark = testing::make_scene(4, 400, 0.1);
  dark.detections[2].clear();
  DriftMonitor monitor(scene.rig, trace_views(scene.rig, kVolume), kVolume, options_of_test(80'000));
  const auto warnings = [&](const ViewScene* shown) {
    if (shown != nullptr) monitor.see(shown->detections);
    StatusReport status;
    monitor.tell(status);
    return status.warnings;
  };
  EXPECT_THAT(warnings(&scene), ::testing::IsEmpty());
  const std::string line = "camera '" + scene.rig.cameras[2].name + "' sees next to no particles and the others do: ";
  EXPECT_THAT(warnings(&dark), ::testing::ElementsAre(HasSubstr(line)));
  EXPECT_THAT(warnings(nullptr), ::testing::ElementsAre(HasSubstr(line))) << "nothing came that says otherwise";
  EXPECT_THAT(warnings(&scene), ::testing::IsEmpty());
  for (auto& view : dark.detections) view.clear();
  EXPECT_THAT(warnings(&dark), ::testing::IsEmpty()) << "there is nothing to see";
}

TEST(DriftMonitor, counts_what_it_passes_over_while_it_rests_and_allocates_nothing_for_a_sample) {
  const ViewScene scene = testing::make_scene(4, 400, 0.1);
  DriftMonitor monitor(scene.rig, trace_views(scene.rig, kVolume), kVolume, options_of_test(80'000));
  AllocationCounter allocations;
  for (int frame = 0; frame < 100; ++frame) monitor.see(scene.detections);
  const std::uint64_t counted = allocations.disarm();
  StatusReport status;
  monitor.tell(status);
  EXPECT_TRUE(status.drift.watched);
  EXPECT_EQ(status.drift.passed_over, 99U);
  EXPECT_EQ(status.drift.looked_at, 0U);
  EXPECT_THAT(status.drift.cameras, ::testing::IsEmpty());
  EXPECT_EQ(counted, 0U);
}

TEST(DriftMonitor, passes_over_a_frame_set_that_it_has_no_room_for) {
  const ViewScene crowded = testing::make_scene(4, 1100, 0.1), scene = testing::make_scene(4, 400, 0.1);
  DriftMonitor monitor(scene.rig, trace_views(scene.rig, kVolume), kVolume, options_of_test(80'000));
  monitor.see(crowded.detections);
  monitor.see(scene.detections);
  StatusReport status;
  monitor.tell(status);
  EXPECT_EQ(status.drift.passed_over, 1U) << "the second was taken";
}

TEST(DriftMonitor, hands_over_while_others_read_its_figures) {
  const ViewScene scene = testing::make_scene(4, 60, 0.1);
  DriftMonitor monitor(scene.rig, trace_views(scene.rig, kVolume), kVolume, options_of_test(0.1));
  std::atomic<bool> done{false};
  std::uint64_t frames = 0;
  std::thread reconstructing([&] {
    for (; !done.load(); ++frames) monitor.see(scene.detections);
  });
  StatusReport status;
  const std::int64_t deadline_ns = host_now_ns() + kDeadlineNs;
  while (status.drift.looked_at < 3 * DriftMonitor::kFramesALook && host_now_ns() < deadline_ns) {
    status.clear();
    monitor.tell(status);
  }
  done.store(true);
  reconstructing.join();
  EXPECT_GE(status.drift.looked_at, 3 * DriftMonitor::kFramesALook);
  status.clear();
  monitor.tell(status);
  const std::uint64_t copied = frames - status.drift.passed_over;
  EXPECT_GE(copied, status.drift.looked_at);
  EXPECT_LE(copied, status.drift.looked_at + 2 * DriftMonitor::kFramesALook);
}

}  // namespace
}  // namespace rptv
