// SPDX-License-Identifier: MIT
// Cameras fitted to points whose places are known: targets with several planes, cubes, dots on a traverse.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/cameras/camera_change.hpp"
#include "calibration/cameras/rig.hpp"

namespace rptv {

/// A point of the target where one camera sees it.
struct KnownPoint {
  std::size_t camera = 0;  ///< of the rig
  Point3 position_mm{};    ///< rig's frame
  Pixel pixel{};
};

/// Columns camera (its name in the rig), x, y, z (mm), column, row (px; pixel centres are integers); others may follow.
/// "-" is standard input. Throws Error(bad_data, no_input, permission) with file and line, also for a camera that the
/// rig has not.
std::vector<KnownPoint> read_known_points(const std::filesystem::path& file, const Rig& rig);
/// The same from text; `origin` stands for the file's name in messages.
std::vector<KnownPoint> parse_known_points(std::string_view text, const std::string& origin, const Rig& rig);

/// How one camera came out. Residuals are the distances of projections from where the points are seen, px.
struct KnownPointsCamera {
  std::size_t points = 0, left_out = 0;  ///< outliers beyond 4 robust standard deviations count in neither rms
  double before_rms_px = 0, rms_px = 0, worst_px = 0;
};

struct KnownPointsFit {
  Rig rig;
  std::vector<KnownPointsCamera> cameras;  ///< in the rig's order; a camera without points stays as it was
};

/// Minimises the residuals camera by camera from `start` (Levenberg-Marquardt, weights after Huber), through the
/// interfaces. Throws Error(bad_data) behind `origin`, with the camera's name, when it sees fewer points than twice the
/// numbers need, cannot see them from where it starts, or when points in a plane or on a line leave the numbers
/// undetermined. Set-up only.
KnownPointsFit fit_known_points(const Rig& start, const std::vector<KnownPoint>& points, CameraFreedom freedom,
                                const std::string& origin);

}  // namespace rptv
