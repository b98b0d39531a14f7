// SPDX-License-Identifier: MIT
// Boards drawn through a camera model, and their points found again where the model puts them.
#include "calibration/cameras/charuco.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <opencv2/aruco/charuco.hpp>
#include <random>

#include "calibration/cameras/board_image.hpp"
#include "calibration/cameras/saddle_fit.hpp"
#include "tests/calibration/cameras/board_rig.hpp"

namespace rptv {
namespace {

/// What a camera sees of a plane z = 0 with a brightness (0 … 1) at each place (mm), averaged over each pixel, with
/// noise.
GreyImage drawn(const CameraModel& camera, const std::function<double(double, double)>& brightness, double noise) {
  constexpr int kSide = 3;  // samples along a pixel's side
  std::mt19937 random(3);
  std::normal_distribution<float> grain(0, static_cast<float>(noise));
  GreyImage image(camera.intrinsics().width_px, camera.intrinsics().height_px);
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      double sum = 0;
      for (int k = 0; k < kSide * kSide; ++k) {
        const SightRay ray =
            camera.ray({column - 0.5 + (k % kSide + 0.5) / kSide, row - 0.5 + (k / kSide + 0.5) / kSide});
        const Point3 p = ray.origin_mm + (-ray.origin_mm[2] / ray.direction[2]) * ray.direction;
        sum += brightness(p[0], p[1]) / (kSide * kSide);
      }
      image.at(column, row) = static_cast<float>(20 + 180 * sum) + grain(random);
    }
  return image;
}

/// 320 x 240 px, distorted, before a target of about 100 mm that is turned and tilted.
CameraModel camera_before(const Point3& middle, double tilt) {
  CameraIntrinsics lens{320, 240, 900, 905, 161, 118};
  lens.k1 = -0.2, lens.p1 = 1e-3;
  const CameraPose pose = looking_at(middle + Point3{420 * std::sin(tilt), 40, -420 * std::cos(tilt)}, middle, 0.2);
  return CameraModel(lens, pose);
}

void expect_where_the_camera_sees_them(const std::vector<SeenPoint>& seen, const Board& board,
                                       const CameraModel& camera, double tolerance_px) {
  const auto points = board.points();
  for (const auto& s : seen) {
    const auto at = camera.project(points[s.point]);
    ASSERT_TRUE(at);
    EXPECT_LT(std::hypot(s.pixel[0] - (*at)[0], s.pixel[1] - (*at)[1]), tolerance_px) << s.point;
  }
}

Board board_4x4() {
  Board board;
  board.columns = board.rows = 4, board.square_mm = 20, board.marker_mm = 15, board.dictionary = "DICT_4X4_50";
  return board;
}

TEST(FindBoard, places_charuco_corners_to_hundredths_of_a_pixel) {
  const Board board = board_4x4();
  constexpr int kPerSquare = 60;
  cv::Mat print;
  cv::aruco::CharucoBoard::create(4, 4, 20, 15, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_4X4_50))
      ->draw({4 * kPerSquare, 4 * kPerSquare}, print);
  const CameraModel camera = camera_before({40, 40, 0}, 0.4);
  const GreyImage image = drawn(
      camera,
      [&](double x, double y) {
        const int column = static_cast<int>(std::floor(x / 20 * kPerSquare)),
                  row = static_cast<int>(std::floor(y / 20 * kPerSquare));
        const bool on = column >= 0 && row >= 0 && column < print.cols && row < print.rows;
        return on ? print.at<std::uint8_t>(row, column) / 255.0 : 1.0;
      },
      1);
  const auto seen = find_charuco(image, board);
  EXPECT_EQ(seen.size(), 9U);
  expect_where_the_camera_sees_them(seen, board, camera, 0.04);
}

TEST(FindBoard, places_dots_of_a_grid_and_keeps_it_upright) {
  Board board;
  board.kind = "dots", board.columns = 5, board.rows = 4, board.square_mm = 20;
  const CameraModel camera = camera_before({40, 30, 0}, -0.2);
  const GreyImage image = drawn(
      camera,
      [](double x, double y) {
        const double column = std::clamp(std::round(x / 20), 0.0, 4.0), row = std::clamp(std::round(y / 20), 0.0, 3.0);
        return std::hypot(x - 20 * column, y - 20 * row) < 5 ? 0.0 : 1.0;
      },
      1);
  const auto seen = find_dots(image, board);
  EXPECT_EQ(seen.size(), 20U);
  expect_where_the_camera_sees_them(seen, board, camera, 0.3);  // a circle's image is not centred on its centre's
}

TEST(FindBoard, finds_nothing_where_there_is_nothing) {
  const GreyImage image = drawn(
      camera_before({40, 40, 0}, 0), [](double x, double) { return x > 30 ? 1.0 : 0.0; }, 1);
  EXPECT_TRUE(find_charuco(image, board_4x4()).empty());
}

std::string why_not(const std::vector<std::uint8_t>& pixels) {
  const ImageShape shape{static_cast<std::uint32_t>(pixels.size()), 1, 1};
  return refusal_of([&] {
    check_board_image({reinterpret_cast<const std::byte*>(pixels.data()), shape}, 8, "cam0_00.png");
  });
}

TEST(CheckBoardImage, refuses_saturated_and_empty_images_by_name) {
  std::vector<std::uint8_t> pixels(1000, 20);
  std::fill(pixels.begin() + 500, pixels.end(), 220);
  EXPECT_EQ(why_not(pixels), "");
  std::fill(pixels.begin() + 800, pixels.end(), 255);
  EXPECT_THAT(why_not(pixels), ::testing::StartsWith("cam0_00.png: is saturated: 40 %"));
  EXPECT_THAT(why_not(std::vector<std::uint8_t>(1000, 3)), ::testing::StartsWith("cam0_00.png: is empty"));
}

TEST(FitSaddle, is_unbiased_and_knows_its_error) {
  std::mt19937 random(5);
  std::normal_distribution<float> grain(0, 3);
  std::uniform_real_distribution<double> any(-0.5, 0.5);
  double sum = 0, squares = 0, expected = 0;
  constexpr int kCorners = 200;
  for (int n = 0; n < kCorners; ++n) {
    const Saddle truth{{12 + any(random), 12 + any(random)}, 0.3 + any(random), 1.9, 1.1, 100, 70};
    GreyImage image(25, 25);
    for (int y = 0; y < 25; ++y)
      for (int x = 0; x < 25; ++x) {
        const auto edge = [&](double angle) {
          const double d = std::cos(angle) * (y - truth.centre[1]) - std::sin(angle) * (x - truth.centre[0]);
          return std::erf(d / truth.blur_px / std::sqrt(2));
        };
        image.at(x, y) = static_cast<float>(truth.level + truth.contrast * edge(truth.angle_1) * edge(truth.angle_2)) +
                         grain(random);
      }
    const Saddle start{{12, 12}, truth.angle_1 + 0.05, truth.angle_2 - 0.05, 1, 0, 0};
    const auto fit = fit_saddle(image, std::vector<std::uint8_t>(625, 0), start, 10);
    ASSERT_TRUE(fit);
    const double error = fit->saddle.centre[0] - truth.centre[0];
    sum += error, squares += error * error, expected += fit->centre_sigma_px * fit->centre_sigma_px;
  }
  EXPECT_LT(std::abs(sum / kCorners), 4 * std::sqrt(squares) / kCorners);
  EXPECT_NEAR(squares / expected, 1, 0.35);
}

}  // namespace
}  // namespace rptv
