// SPDX-License-Identifier: MIT
// Finds the corners of a ChArUco board in an image, to a few hundredths of a pixel.
#pragma once

#include <vector>

#include "calibration/cameras/board.hpp"
#include "calibration/cameras/board_views.hpp"
#include "calibration/grey_image.hpp"

namespace rptv {

/// Corners of `board` (kind "charuco") between two markers that were recognised, refined where black meets white
/// within the largest window that holds nothing but the corner. Empty when fewer than two markers are seen. Grey values
/// of any depth; set-up only, throws Error(internal) when OpenCV fails.
std::vector<SeenPoint> find_charuco(const GreyImage& image, const Board& board);

/// Dots of `board` (kind "dots"): all of them, or none. The grid is taken to stand upright, within 45 degrees: its
/// x axis points to the right in the image.
std::vector<SeenPoint> find_dots(const GreyImage& image, const Board& board);

}  // namespace rptv
