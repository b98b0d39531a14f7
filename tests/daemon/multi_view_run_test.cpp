// SPDX-License-Identifier: MIT
// Four cameras from image files to tables, by the real binary: `run` and `reconstruct` give the same points.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/points_table.hpp"
#include "daemon/live_listener.hpp"
#include "daemon/session.hpp"
#include "reconstruct/detection/detector.hpp"
#include "tests/daemon/painted_recording.hpp"
#include "tests/daemon/run_binary.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::PaintedRecording;

std::vector<double> depths(const std::string& file) {
  PointsReader reader(file);
  std::vector<double> depths;
  for (PointFrame frame; reader.next(frame);)
    for (const PointRow& point : frame.points) depths.push_back(point.z_mm);
  return depths;
}

TEST(MultiViewRun, gives_the_points_that_reconstruct_gives) {
  const PaintedRecording recording;
  const auto check = recording.check();
  EXPECT_EQ(check.code, 0) << check.out << check.err;
  EXPECT_THAT(check.out, Not(HasSubstr("warning")));
  const auto run =
      testing::run_rapidptv({"run", "--config", recording.file("run.toml"), "--points", recording.file("run.csv")});
  EXPECT_EQ(run.code, 0) << run.err;
  const auto table =
      testing::run_rapidptv({"reconstruct", "--config", recording.file("run.toml"), "-o", recording.file("table.csv")});
  EXPECT_EQ(table.code, 0) << table.err;
  EXPECT_THAT(table.err, HasSubstr("reconstructed 2 of 2 instants"));
  EXPECT_GT(depths(recording.file("run.csv")).size(), 70U);
  EXPECT_EQ(depths(recording.file("run.csv")), depths(recording.file("table.csv")));

  std::filesystem::remove(recording.file("frames/cam2_1.png"));
  const auto less =
      testing::run_rapidptv({"reconstruct", "--config", recording.file("run.toml"), "-o", recording.file("less.csv")});
  EXPECT_EQ(less.code, 0) << less.err;
  EXPECT_THAT(less.err, HasSubstr("1 images were missing"));
  EXPECT_GT(depths(recording.file("less.csv")).size(), 60U);
}

TEST(MultiViewRun, by_iteration_gives_them_too_with_and_without_tracks) {
  const PaintedRecording recording;
  const std::vector<std::string> iterative{"--config", recording.file("run.toml"), "--set",
                                           "multi_view.method=iterative"};
  const auto with = [&](const std::string& command, std::vector<std::string> more) {
    more.insert(more.begin(), iterative.begin(), iterative.end());
    more.insert(more.begin(), command);
    const auto said = testing::run_rapidptv(more);
    EXPECT_EQ(said.code, 0) << said.err;
    return said.err;
  };
  with("run", {"--points", recording.file("tracked.csv")});
  with("run", {"--points", recording.file("run.csv"), "--set", "multi_view.iterative.use_tracks=false"});
  EXPECT_THAT(with("reconstruct", {"-o", recording.file("table.csv")}), HasSubstr("reconstructed 2 of 2 instants"));
  EXPECT_NEAR(static_cast<double>(depths(recording.file("table.csv")).size()), 80, 4);
  EXPECT_EQ(depths(recording.file("run.csv")), depths(recording.file("table.csv")));
  EXPECT_NEAR(static_cast<double>(depths(recording.file("tracked.csv")).size()), 80, 4);
}

const LossCount* loss_of(const std::vector<LossCount>& losses, LossCause cause) {
  const auto found = std::find_if(losses.begin(), losses.end(), [cause](const LossCount& loss) {
    return loss.cause == cause && loss.place == "reconstruction";
  });
  return found == losses.end() ? nullptr : &*found;
}

TEST(MultiViewRun, says_in_status_and_report_what_reconstruction_left_out) {
  const PaintedRecording recording;
  Config config = load_config(recording.file("run.toml"), {"multi_view.detector.max_detections=16", "replay.loop=0"});
  config.publisher.status_period_ms = 50;
  LiveListener listener(config.publisher.endpoint);
  Session session(config);
  session.start();
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  while (loss_of(listener.status().losses, LossCause::detection_overflow) == nullptr && host_now_ns() < deadline_ns)
    listener.poll(100);
  session.stop();
  const LossCount* told = loss_of(listener.status().losses, LossCause::detection_overflow);
  ASSERT_NE(told, nullptr);
  const SessionReport report = session.report();
  const LossCount* kept = loss_of(report.losses, LossCause::detection_overflow);
  ASSERT_NE(kept, nullptr);
  EXPECT_GE(kept->count, told->count);
  EXPECT_GE(kept->count, report.counts.linked * 4 * 20) << "each view has some 40 particle images and room for 16";
  EXPECT_THAT(to_text(report), HasSubstr("lost: " + std::to_string(kept->count) +
                                         " × detection_overflow at reconstruction: raise multi_view.detector."));
  EXPECT_THAT(to_json(report), HasSubstr(R"({"place":"reconstruction","cause":"detection_overflow","count":)" +
                                         std::to_string(kept->count) + "}"));
}

/// Detects as the CPU does, for one frame set; then it is lost.
class LostDevice final : public DetectDevice {
 public:
  explicit LostDevice(const DetectDevicePlan& plan) {
    for (const ImageShape& shape : plan.shapes) detectors_.emplace_back(plan.settings, shape);
  }
  bool detect(std::span<const ImageView> images, std::span<Detections> seen) noexcept override {
    for (std::size_t c = 0; c < images.size(); ++c) detectors_[c].detect(images[c], seen[c]);
    return !std::exchange(lost_, true);
  }

 private:
  std::vector<Detector> detectors_;
  bool lost_ = false;
};

TEST(MultiViewRun, goes_on_without_a_device_that_is_lost_and_says_so) {
  const PaintedRecording recording;
  Config config = load_config(recording.file("run.toml"), {"replay.loop=0"});
  config.publisher.status_period_ms = 50;
  auto source = make_source(config);
  std::vector<MultiViewCamera> cameras;
  for (const CameraInfo& camera : source->cameras()) cameras.push_back({camera.name, camera.shape, {}});
  LiveListener listener(config.publisher.endpoint);
  Session session(
      config, std::move(source),
      std::make_unique<MultiView>(config.multi_view, read_rig(config.multi_view.rig), cameras,
                                  [](const DetectDevicePlan& plan) { return std::make_unique<LostDevice>(plan); }));
  session.start();
  const auto told = [&] {
    const auto& warnings = listener.status().warnings;
    return std::any_of(warnings.begin(), warnings.end(),
                       [](const std::string& line) { return line.rfind("the GPU failed; the CPU has done", 0) == 0; });
  };
  const std::int64_t deadline_ns = host_now_ns() + 60'000'000'000;
  while (!told() && host_now_ns() < deadline_ns) listener.poll(100);
  session.stop();
  EXPECT_TRUE(told());
  const SessionReport report = session.report();
  EXPECT_EQ(report.sets_without_device, report.counts.linked - 1);
  EXPECT_GE(report.counts.particles, 35 * report.counts.linked);
  EXPECT_THAT(to_text(report), HasSubstr("the GPU failed; the CPU has done " +
                                         std::to_string(report.sets_without_device) + " frame sets alone since"));
  EXPECT_THAT(to_json(report),
              HasSubstr("\"sets_without_device\":" + std::to_string(report.sets_without_device) + ","));
}

TEST(MultiViewRun, of_one_light_field_says_which_key_to_set) {
  const PaintedRecording recording;
  const auto said = testing::run_rapidptv(
      {"run", "--config", recording.file("run.toml"), "--set", "reconstruction.kind=light_field"});
  EXPECT_EQ(said.code, 78);
  EXPECT_THAT(said.err,
              HasSubstr("the source has 4; give one camera's folder as its path, or set reconstruction.kind"));
}

}  // namespace
}  // namespace rptv
