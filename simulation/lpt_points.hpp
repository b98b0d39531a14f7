// SPDX-License-Identifier: MIT
// The text files of the Lagrangian particle tracking challenge: a particle a line, X Y Z x1 y1 … xN yN.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/cameras/brown_distortion.hpp"
#include "calibration/space.hpp"

namespace rptv {

/// A particle and where each camera sees it; NaN where one does not.
struct LptPoint {
  Point3 position_mm{};
  std::vector<Pixel> pixels;
};

/// Reads such a file; lines that start with a letter or # are titles. Every line has the same number of cameras, at
/// least 1. Throws Error (no_input, bad_data) with file and line.
std::vector<LptPoint> read_lpt_points(const std::filesystem::path& file);
std::vector<LptPoint> parse_lpt_points(std::string_view text, const std::string& origin);

/// The same as text: positions and pixels so that they read back bit for bit.
std::string lpt_points_text(const std::vector<LptPoint>& points);

}  // namespace rptv
