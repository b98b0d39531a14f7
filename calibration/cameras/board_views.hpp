// SPDX-License-Identifier: MIT
// Which points of a target were seen where, by several cameras in several views.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "calibration/cameras/camera_model.hpp"

namespace rptv {

/// A point of the target in an image.
struct SeenPoint {
  std::size_t point = 0;  ///< its place in Board::points()
  Pixel pixel{};          ///< column, row
};

/// One image of the target.
struct BoardView {
  std::size_t camera = 0, view = 0;  ///< places in BoardSet::cameras and views
  std::string origin;                ///< the image's name in messages
  std::vector<SeenPoint> seen;       ///< rising by point
};

struct CameraImages {
  std::string name;
  int width_px = 0, height_px = 0;
};

/// Everything that a calibration of several cameras is made from. A view is one pose of the target, seen by several
/// cameras at one time.
struct BoardSet {
  std::vector<Point3> target_mm;
  std::vector<CameraImages> cameras;
  std::vector<std::string> views;  ///< their names
  std::vector<BoardView> images;   ///< at most one for each camera and view
};

}  // namespace rptv
