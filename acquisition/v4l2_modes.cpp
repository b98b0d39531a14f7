// SPDX-License-Identifier: MIT
// The kernel's enumerations of sizes and frame intervals.
#include "acquisition/v4l2_modes.hpp"

#include <linux/videodev2.h>

#include <cstdio>

namespace rptv {
namespace {

constexpr std::uint32_t kMost = 16;

std::string size_text(std::uint32_t width_px, std::uint32_t height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px);
}

std::string rate_text(const v4l2_fract& interval) {
  char text[32] = "?";
  if (interval.numerator != 0)
    std::snprintf(text, sizeof text, "%.6g", static_cast<double>(interval.denominator) / interval.numerator);
  return text;
}

void append(std::string& list, const std::string& one) { list += (list.empty() ? "" : ", ") + one; }

}  // namespace

std::string v4l2_sizes(V4l2System& system, int descriptor, std::uint32_t fourcc) {
  std::string all;
  v4l2_frmsizeenum size{};
  size.pixel_format = fourcc;
  for (; system.call(descriptor, VIDIOC_ENUM_FRAMESIZES, &size) == 0 && size.index < kMost; ++size.index) {
    if (size.type == V4L2_FRMSIZE_TYPE_DISCRETE) {
      append(all, size_text(size.discrete.width, size.discrete.height));
      continue;
    }
    const v4l2_frmsize_stepwise& range = size.stepwise;
    append(all, size_text(range.min_width, range.min_height) + " to " + size_text(range.max_width, range.max_height) +
                    " in steps of " + size_text(range.step_width, range.step_height));
    break;
  }
  return all.empty() ? all : all + " px";
}

std::string v4l2_rates(V4l2System& system, int descriptor, std::uint32_t fourcc, std::uint32_t width_px,
                       std::uint32_t height_px) {
  std::string all;
  v4l2_frmivalenum interval{};
  interval.pixel_format = fourcc;
  interval.width = width_px;
  interval.height = height_px;
  for (; system.call(descriptor, VIDIOC_ENUM_FRAMEINTERVALS, &interval) == 0 && interval.index < kMost;
       ++interval.index) {
    if (interval.type == V4L2_FRMIVAL_TYPE_DISCRETE) {
      append(all, rate_text(interval.discrete));
      continue;
    }
    append(all, rate_text(interval.stepwise.max) + " to " + rate_text(interval.stepwise.min));
    break;
  }
  return all.empty() ? all : all + " Hz";
}

}  // namespace rptv
