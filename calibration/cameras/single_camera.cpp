// SPDX-License-Identifier: MIT
// OpenCV's calibration and pose estimation, with checks that the views can tell what is asked of them.
#include "calibration/cameras/single_camera.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/calib3d.hpp>

#include "calibration/cameras/board.hpp"
#include "calibration/cameras/median.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr std::size_t kLeastPoints = 8;  // of a view
constexpr std::size_t kLeastViews = 3;   // of a flat target
constexpr double kLeastTilt_deg = 10;    // between some two views: less does not tell the focal length
constexpr double kWorstRms_px = 3, kWorstBehindGlass_px = 30;
constexpr double kWorseThanMedian = 4, kNeverDropped_px = 0.3;

CameraPose pose_of(const cv::Mat& turn, const cv::Mat& shift) {
  cv::Mat rotation;
  cv::Rodrigues(turn, rotation);
  CameraPose pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column)
      pose.rotation[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)] = rotation.at<double>(row, column);
    pose.translation_mm[static_cast<std::size_t>(row)] = shift.at<double>(row);
  }
  return pose;
}

struct PointLists {
  std::vector<cv::Point3f> target;
  std::vector<cv::Point2f> pixel;
};

PointLists lists_of(const std::vector<Point3>& target_mm, const std::vector<SeenPoint>& seen) {
  PointLists lists;
  for (const auto& s : seen) {
    const Point3& p = target_mm[s.point];
    lists.target.emplace_back(static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]));
    lists.pixel.emplace_back(static_cast<float>(s.pixel[0]), static_cast<float>(s.pixel[1]));
  }
  return lists;
}

cv::Mat matrix_of(const CameraIntrinsics& lens) {
  return (cv::Mat_<double>(3, 3) << lens.fx_px, 0, lens.cx_px, 0, lens.fy_px, lens.cy_px, 0, 0, 1);
}

CameraIntrinsics lens_of(const CameraImages& images, const cv::Mat& matrix, const cv::Mat& distortion) {
  CameraIntrinsics lens;
  lens.width_px = images.width_px, lens.height_px = images.height_px;
  lens.fx_px = matrix.at<double>(0, 0), lens.fy_px = matrix.at<double>(1, 1);
  lens.cx_px = matrix.at<double>(0, 2), lens.cy_px = matrix.at<double>(1, 2);
  lens.k1 = distortion.at<double>(0), lens.k2 = distortion.at<double>(1), lens.p1 = distortion.at<double>(2);
  lens.p2 = distortion.at<double>(3), lens.k3 = distortion.at<double>(4);
  return lens;
}

/// Camera matrix of one view of a target that is not flat: direct linear transform, then RQ (Hartley and Zisserman
/// 2004, 7.1 and 6.2.4), about the middle of the points and in units of their spread.
cv::Mat start_by_dlt(const PointLists& lists) {
  cv::Scalar middle = cv::mean(lists.target);
  const int n = static_cast<int>(lists.target.size());
  cv::Mat rows = cv::Mat::zeros(2 * n, 12, CV_64F);
  for (int i = 0; i < n; ++i) {
    const auto& p = lists.target[static_cast<std::size_t>(i)];
    const auto& q = lists.pixel[static_cast<std::size_t>(i)];
    const double x[4] = {p.x - middle[0], p.y - middle[1], p.z - middle[2], 1};
    for (int k = 0; k < 4; ++k) {
      rows.at<double>(2 * i, k) = rows.at<double>(2 * i + 1, 4 + k) = x[k];
      rows.at<double>(2 * i, 8 + k) = -q.x * x[k], rows.at<double>(2 * i + 1, 8 + k) = -q.y * x[k];
    }
  }
  cv::Mat scale(1, 12, CV_64F);
  for (int k = 0; k < 12; ++k) {
    scale.at<double>(k) = 1 / std::max(cv::norm(rows.col(k)), 1e-12);
    rows.col(k) *= scale.at<double>(k);
  }
  cv::Mat solution;
  cv::SVD::solveZ(rows, solution);
  cv::Mat projection = cv::Mat(solution.t()).mul(scale);
  projection = projection.reshape(1, 3);
  if (cv::determinant(projection.colRange(0, 3)) < 0) projection = -projection;
  cv::Mat matrix, rotation, place;
  cv::decomposeProjectionMatrix(projection, matrix, rotation, place);
  matrix /= matrix.at<double>(2, 2);
  matrix.at<double>(0, 1) = 0;
  return matrix;
}

/// Largest angle between the normals of any two views, degrees.
double tilt_deg(const std::vector<cv::Mat>& turns) {
  double least = 1;
  for (std::size_t i = 0; i < turns.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const CameraPose a = pose_of(turns[i], cv::Mat::zeros(3, 1, CV_64F)),
                       b = pose_of(turns[j], cv::Mat::zeros(3, 1, CV_64F));
      least = std::min(least, std::abs(dot(transpose(a.rotation)[2], transpose(b.rotation)[2])));
    }
  return std::acos(std::clamp(least, -1.0, 1.0)) * 180 / std::numbers::pi;
}

struct Fit {
  std::vector<std::size_t> views;  // of the set
  std::vector<PointLists> lists;
  cv::Mat matrix, distortion, spread, view_rms;
  std::vector<cv::Mat> turns, shifts;
  double rms_px = 0;

  void leave_out(std::size_t k) {
    views.erase(views.begin() + static_cast<std::ptrdiff_t>(k)),
        lists.erase(lists.begin() + static_cast<std::ptrdiff_t>(k));
  }
  void solve(const CameraImages& camera, bool flat, bool fit_k3) {
    int flags = fit_k3 ? 0 : cv::CALIB_FIX_K3;
    if (!flat && matrix.empty()) matrix = start_by_dlt(lists.front());
    if (!flat) flags |= cv::CALIB_USE_INTRINSIC_GUESS;
    std::vector<std::vector<cv::Point3f>> target;
    std::vector<std::vector<cv::Point2f>> pixel;
    for (const auto& l : lists) target.push_back(l.target), pixel.push_back(l.pixel);
    cv::Mat ignored;
    rms_px = cv::calibrateCamera(target, pixel, {camera.width_px, camera.height_px}, matrix, distortion, turns, shifts,
                                 spread, ignored, view_rms, flags);
  }
};

/// Leaves out views that fit several times worse than the median; false when there is none.
bool drop_worst(Fit& fit, std::size_t camera, std::vector<DroppedView>& dropped) {
  const double middle = median({fit.view_rms.begin<double>(), fit.view_rms.end<double>()});
  const std::size_t before = fit.views.size();
  for (std::size_t k = before; k-- > 0;) {
    const double rms = fit.view_rms.at<double>(static_cast<int>(k));
    if (rms <= std::max(kWorseThanMedian * middle, kNeverDropped_px)) continue;
    dropped.push_back({camera, fit.views[k], fmt::format("rms {:.3f} px, the median is {:.3f} px", rms, middle)});
    fit.leave_out(k);
  }
  return fit.views.size() < before;
}

}  // namespace

double rms_px(const CameraIntrinsics& lens, const CameraPose& pose, const std::vector<Point3>& target_mm,
              const std::vector<SeenPoint>& seen) {
  const CameraModel model(lens, pose);
  double sum = 0;
  for (const auto& s : seen) {
    const auto at = model.project(target_mm[s.point]);
    if (!at) return std::numeric_limits<double>::infinity();
    sum += std::pow((*at)[0] - s.pixel[0], 2) + std::pow((*at)[1] - s.pixel[1], 2);
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(seen.size(), 1)));
}

std::optional<CameraPose> target_pose(const CameraIntrinsics& lens, const std::vector<Point3>& target_mm,
                                      const std::vector<SeenPoint>& seen) {
  if (seen.size() < kLeastPoints) return std::nullopt;
  const PointLists lists = lists_of(target_mm, seen);
  const cv::Mat distortion = (cv::Mat_<double>(5, 1) << lens.k1, lens.k2, lens.p1, lens.p2, lens.k3);
  try {
    cv::Mat turn, shift;
    if (!cv::solvePnP(lists.target, lists.pixel, matrix_of(lens), distortion, turn, shift)) return std::nullopt;
    return pose_of(turn, shift);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
}

SingleCamera fit_single_camera(const BoardSet& set, std::size_t camera, const SingleCameraOptions& options) {
  const CameraImages& images = set.cameras[camera];
  const auto refuse = [&](const std::string& text) {
    throw Error(ExitCode::bad_data, fmt::format("camera {}: {}", images.name, text));
  };
  const bool flat = is_flat(set.target_mm);
  SingleCamera result;
  result.target.resize(set.views.size());
  result.view_rms_px.resize(set.views.size());
  Fit fit;
  for (const auto& image : set.images) {
    if (image.camera != camera) continue;
    if (image.seen.size() < kLeastPoints) {
      result.dropped.push_back(
          {camera, image.view, fmt::format("{} points seen, {} are needed", image.seen.size(), kLeastPoints)});
      continue;
    }
    fit.views.push_back(image.view), fit.lists.push_back(lists_of(set.target_mm, image.seen));
  }
  const std::size_t least = flat ? kLeastViews : 1;
  const auto check_count = [&] {
    if (fit.views.size() < least)
      refuse(fmt::format("sees the target well enough in {} views; a calibration needs at least {}, better 15",
                         fit.views.size(), least));
  };
  check_count();
  try {
    fit.solve(images, flat, options.fit_k3);
    for (int round = 0; options.drop_outliers && !options.behind_glass && round < 3; ++round) {
      if (!drop_worst(fit, camera, result.dropped)) break;
      check_count();
      fit.solve(images, flat, options.fit_k3);
    }
  } catch (const cv::Exception& failure) {
    refuse(std::string("its views fit no lens (OpenCV: ") + failure.err + "); check the board's file and the images");
  }
  if (const double tilt = tilt_deg(fit.turns); flat && tilt < kLeastTilt_deg)
    refuse(
        fmt::format("shows the target in one orientation only: its {} views differ by {:.1f} degrees at most, which "
                    "does not tell the focal length; tilt it by 20 to 45 degrees to all sides",
                    fit.views.size(), tilt));
  if (!(fit.rms_px < (options.behind_glass ? kWorstBehindGlass_px : kWorstRms_px)))
    refuse(
        fmt::format("its views fit a lens only to {:.1f} px; check the board's file (size, columns, rows, marker "
                    "set) and whether all images are of one lens setting",
                    fit.rms_px));
  result.lens = lens_of(images, fit.matrix, fit.distortion);
  for (std::size_t k = 0; k < fit.views.size(); ++k) {
    result.target[fit.views[k]] = pose_of(fit.turns[k], fit.shifts[k]);
    result.view_rms_px[fit.views[k]] = fit.view_rms.at<double>(static_cast<int>(k));
  }
  result.rms_px = fit.rms_px;
  return result;
}

}  // namespace rptv
