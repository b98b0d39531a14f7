// SPDX-License-Identifier: MIT
// Dots of a plain grid by OpenCV, numbered so that the grid stands upright.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>

#include "calibration/cameras/charuco.hpp"
#include "calibration/opencv_image.hpp"
#include "core/error.hpp"

namespace rptv {

std::vector<SeenPoint> find_dots(const GreyImage& image, const Board& board) {
  try {
    const cv::Mat bytes = as_bytes(image);
    const cv::Size size(static_cast<int>(board.columns), static_cast<int>(board.rows));
    std::vector<cv::Point2f> dots;
    for (const int polarity : {0, 255}) {  // dark dots on bright ground, or bright on dark
      cv::SimpleBlobDetector::Params blob;
      blob.blobColor = static_cast<uchar>(polarity);
      blob.minArea = 10, blob.maxArea = 0.02F * static_cast<float>(bytes.total());
      blob.minDistBetweenBlobs = 3;
      if (cv::findCirclesGrid(bytes, size, dots, cv::CALIB_CB_SYMMETRIC_GRID | cv::CALIB_CB_CLUSTERING,
                              cv::SimpleBlobDetector::create(blob)))
        break;
      dots.clear();
    }
    if (dots.empty()) return {};
    const std::ptrdiff_t columns = board.columns;
    // The finder may begin at any corner: x goes to the right and y down.
    if (dots[static_cast<std::size_t>(columns - 1)].x < dots[0].x)
      for (auto row = dots.begin(); row != dots.end(); row += columns) std::reverse(row, row + columns);
    if (dots.back().y < dots[0].y)
      for (std::ptrdiff_t top = 0, bottom = board.rows - 1; top < bottom; ++top, --bottom)
        std::swap_ranges(dots.begin() + top * columns, dots.begin() + (top + 1) * columns,
                         dots.begin() + bottom * columns);
    std::vector<SeenPoint> seen;
    for (std::size_t i = 0; i < dots.size(); ++i) seen.push_back({i, {dots[i].x, dots[i].y}});
    return seen;
  } catch (const cv::Exception& failure) {
    throw Error(ExitCode::internal, std::string("finding the dots failed in OpenCV: ") + failure.err);
  }
}

}  // namespace rptv
