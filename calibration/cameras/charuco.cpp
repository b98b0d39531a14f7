// SPDX-License-Identifier: MIT
// Markers and a first guess of the corners by OpenCV; then a fit of each corner to the grey values round it.
#include "calibration/cameras/charuco.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>

#include "calibration/cameras/saddle_fit.hpp"
#include "calibration/opencv_image.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr int kMarkerMargin_px = 3;
constexpr double kSmallestRadius_px = 4, kLargestRadius_px = 14;  // less is noise, more is distortion

using Quad = std::vector<cv::Point2f>;

/// Pixels that markers, with what blurs out of them, may have changed.
std::vector<std::uint8_t> hidden_by(const std::vector<Quad>& markers, const cv::Size& size) {
  cv::Mat mask = cv::Mat::zeros(size, CV_8UC1);
  for (const auto& marker : markers) {
    std::vector<cv::Point> outline;
    for (const auto& p : marker) outline.emplace_back(cvRound(p.x), cvRound(p.y));
    cv::fillConvexPoly(mask, outline, 1);
    cv::polylines(mask, outline, true, 1, 2 * kMarkerMargin_px + 1);
  }
  return {mask.begin<std::uint8_t>(), mask.end<std::uint8_t>()};
}

const Quad& nearest(const std::vector<Quad>& markers, const cv::Point2f& corner) {
  return *std::min_element(markers.begin(), markers.end(), [&](const Quad& a, const Quad& b) {
    const auto far = [&](const Quad& q) { return cv::norm(0.25F * (q[0] + q[1] + q[2] + q[3]) - corner); };
    return far(a) < far(b);
  });
}

/// The corner between squares whose edges run along those of the nearest marker.
std::optional<SeenPoint> refined(const GreyImage& image, const std::vector<std::uint8_t>& hidden, const Quad& marker,
                                 const cv::Point2f& corner, double squares_per_marker) {
  const cv::Point2f across = marker[1] - marker[0], down = marker[2] - marker[1];
  Saddle start{{corner.x, corner.y}, std::atan2(across.y, across.x), std::atan2(down.y, down.x), 1, 0, 0};
  const double side = squares_per_marker * std::min(cv::norm(across), cv::norm(down));
  const double radius = std::min(kLargestRadius_px, 0.45 * side);
  if (radius < kSmallestRadius_px) return std::nullopt;
  const auto fit = fit_saddle(image, hidden, start, radius);
  if (!fit) return std::nullopt;
  return SeenPoint{0, fit->saddle.centre};
}

}  // namespace

std::vector<SeenPoint> find_charuco(const GreyImage& image, const Board& board) {
  try {
    const auto dictionary = cv::aruco::getPredefinedDictionary(static_cast<int>(marker_set_of(board.dictionary)));
    const auto pattern = cv::aruco::CharucoBoard::create(static_cast<int>(board.columns), static_cast<int>(board.rows),
                                                         static_cast<float>(board.square_mm),
                                                         static_cast<float>(board.marker_mm), dictionary);
    const cv::Mat bytes = as_bytes(image);
    std::vector<std::vector<cv::Point2f>> markers;
    std::vector<int> marker_ids, corner_ids;
    cv::aruco::detectMarkers(bytes, dictionary, markers, marker_ids);
    std::vector<cv::Point2f> corners;
    if (marker_ids.size() >= 2)
      cv::aruco::interpolateCornersCharuco(markers, marker_ids, bytes, pattern, corners, corner_ids);
    const auto hidden = hidden_by(markers, bytes.size());
    std::vector<SeenPoint> seen;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      auto point = refined(image, hidden, nearest(markers, corners[i]), corners[i], board.square_mm / board.marker_mm);
      if (!point) continue;
      point->point = static_cast<std::size_t>(corner_ids[i]);
      seen.push_back(*point);
    }
    std::sort(seen.begin(), seen.end(), [](const SeenPoint& a, const SeenPoint& b) { return a.point < b.point; });
    return seen;
  } catch (const cv::Exception& failure) {
    throw Error(ExitCode::internal, std::string("finding the board failed in OpenCV: ") + failure.err);
  }
}

}  // namespace rptv
