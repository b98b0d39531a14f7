// SPDX-License-Identifier: MIT
// Images as OpenCV takes them; for the few sources of calibration/ that call it.
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>

#include "calibration/grey_image.hpp"

namespace rptv {

/// The same pixels, not copied: `image` must outlive it.
inline cv::Mat wrapped(const GreyImage& image) {
  return {image.height, image.width, CV_32FC1, const_cast<float*>(image.grey.data())};
}

/// 8 bits; what is brighter than 255 is scaled down so that all but the brightest thousandth fits.
inline cv::Mat as_bytes(const GreyImage& image) {
  std::vector<float> sorted = image.grey;
  const auto top = sorted.begin() + static_cast<std::ptrdiff_t>(0.999 * static_cast<double>(sorted.size() - 1));
  std::nth_element(sorted.begin(), top, sorted.end());
  cv::Mat bytes;
  wrapped(image).convertTo(bytes, CV_8UC1, *top > 255 ? 255.0 / *top : 1.0);
  return bytes;
}

}  // namespace rptv
