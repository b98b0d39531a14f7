// SPDX-License-Identifier: MIT
// Detections of several views that may be one particle, and where it would be.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "calibration/space.hpp"
#include "core/frame.hpp"

namespace rptv {

inline constexpr std::size_t kMaxViews = kMaxCameras;
inline constexpr std::uint32_t kUnseen = 0xFFFFFFFF;

/// One detection, or kUnseen, in each view.
struct ViewTuple {
  std::array<std::uint32_t, kMaxViews> detection;
  std::uint32_t views;  ///< that see it

  static ViewTuple none() noexcept {
    ViewTuple tuple;
    tuple.detection.fill(kUnseen);
    tuple.views = 0;
    return tuple;
  }
  void put(std::size_t view, std::uint32_t number) noexcept {
    views += static_cast<std::uint32_t>(detection[view] == kUnseen) - static_cast<std::uint32_t>(number == kUnseen);
    detection[view] = number;
  }
  bool operator==(const ViewTuple&) const = default;
};

/// A tuple whose rays meet. The point is relative to the centre of the volume, mm.
struct ViewMatch {
  ViewTuple tuple;
  Point3 at_mm;
  double square_px2;  ///< sum over the views of the squared reprojection error at that point
  double s;           ///< smallest singular value of eq. (4)
};

}  // namespace rptv
