// SPDX-License-Identifier: MIT
// The shared set of 20 ChArUco poses before 4 cameras, rendered with distortion, blur and noise: figures against truth.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/core/persistence.hpp>

#include "calibration/cameras/board_image.hpp"
#include "calibration/cameras/calibrate_cameras.hpp"
#include "calibration/cameras/rig_accuracy.hpp"
#include "calibration/space_algebra.hpp"
#include "replay/image_file.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kCameras = 4, kViews = 20;

CameraPose pose_in(const cv::FileNode& node) {
  CameraPose pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      pose.rotation[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] =
          static_cast<double>(node["R"][row][column]);
    pose.translation_mm[static_cast<std::size_t>(row)] = static_cast<double>(node["T"][row]);
  }
  return pose;
}

BoardSet read_set(const fs::path& folder) {
  Board board;
  board.columns = 7, board.rows = 10, board.square_mm = 20, board.marker_mm = 15;
  BoardSet set;
  set.target_mm = board.points();
  for (std::size_t v = 0; v < kViews; ++v) set.views.push_back(fmt::format("{:02}", v));
  for (std::size_t c = 0; c < kCameras; ++c) {
    set.cameras.push_back({fmt::format("cam{}", c), 1920, 1200});
    for (std::size_t v = 0; v < kViews; ++v) {
      const std::string name = fmt::format("cam{}_{}.png", c, set.views[v]);
      const auto reader = open_image(folder / name);
      std::vector<std::byte> pixels(reader->header(0).shape.bytes());
      reader->decode(0, pixels);
      set.images.push_back({c, v, name, find_board({pixels.data(), reader->header(0).shape}, board)});
    }
  }
  return set;
}

/// Corners triangulated from what the cameras saw against the true ones, in the first camera's frame; root of the mean
/// squared distance, mm.
double corner_error_mm(const BoardSet& set, const Bundle& found, const std::vector<CameraPose>& targets) {
  const auto models = models_of(found);
  double sum = 0;
  int count = 0;
  for (std::size_t v = 0; v < kViews; ++v)
    for (std::size_t p = 0; p < set.target_mm.size(); ++p) {
      std::vector<Sighting> sightings;
      for (const auto& image : set.images)
        for (const auto& s : image.seen)
          if (image.view == v && s.point == p) sightings.push_back({&models[image.camera], s.pixel});
      const auto at = triangulate(sightings);
      if (!at) continue;
      const double error = norm(*at - (targets[v].rotation * set.target_mm[p] + targets[v].translation_mm));
      sum += error * error, ++count;
    }
  EXPECT_GT(count, 1000);
  return std::sqrt(sum / count);
}

TEST(FourCameras, are_calibrated_to_hundredths_of_a_pixel_and_of_a_millimetre) {
  const char* root = std::getenv("RPTV_SHARED_DATA");
  const fs::path data = fs::path(root != nullptr ? root : "") / "four-cameras";
  if (root == nullptr || !fs::exists(data / "calibration_truth.json"))
    GTEST_SKIP() << "RPTV_SHARED_DATA does not name the research data";
  const cv::FileStorage cameras((data / "calibration_truth.json").string(), cv::FileStorage::READ);
  const cv::FileStorage poses((data / "charuco" / "poses_truth.json").string(), cv::FileStorage::READ);
  const BoardSet set = read_set(data / "charuco");
  const CameraCalibration c = calibrate_cameras(set, {});
  const Bundle& found = c.result.bundle;

  const CameraPose first = pose_in(cameras["cameras"][0]);  // truth's frame to the first camera's, which is the rig's
  double camera_deg = 0, camera_mm = 0, target_deg = 0, target_mm = 0;
  std::vector<CameraPose> targets;
  for (std::size_t k = 0; k < kCameras; ++k) {
    const CameraPose truth = after(pose_in(cameras["cameras"][static_cast<int>(k)]), inverse(first));
    camera_deg = std::max(camera_deg, angle_deg(found.cameras[k].rotation * transpose(truth.rotation)));
    camera_mm = std::max(camera_mm, norm(inverse(found.cameras[k]).translation_mm - inverse(truth).translation_mm));
  }
  for (std::size_t v = 0; v < kViews; ++v) {
    targets.push_back(after(first, pose_in(poses["poses"][static_cast<int>(v)])));
    target_deg = std::max(target_deg, angle_deg(found.targets[v]->rotation * transpose(targets[v].rotation)));
    target_mm = std::max(target_mm, norm(found.targets[v]->translation_mm - targets[v].translation_mm));
  }
  const double corner_mm = corner_error_mm(set, found, targets);
  std::cout << fmt::format(
      "four-cameras, all in the first camera's frame: reprojection rms {:.4f} px ({} of 4320 corners, standard error "
      "{:.4f} px); corners in space {:.4f} mm rms; cameras within {:.4f} deg, {:.4f} mm; boards within {:.4f} deg, "
      "{:.4f} mm\n",
      c.result.rms_px, c.result.residuals.size(), c.result.sigma_px, corner_mm, camera_deg, camera_mm, target_deg,
      target_mm);
  EXPECT_TRUE(c.dropped.empty());
  EXPECT_GT(c.result.residuals.size(), 4200U);
  EXPECT_LT(c.result.rms_px, 0.015);
  EXPECT_LT(corner_mm, 0.05);
  EXPECT_LT(camera_deg, 0.05);
  EXPECT_LT(camera_mm, 0.2);
  EXPECT_LT(target_deg, 0.05);
  EXPECT_LT(target_mm, 0.2);
}

}  // namespace
}  // namespace rptv
