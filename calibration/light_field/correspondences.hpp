// SPDX-License-Identifier: MIT
// Points known in image and in object space, from a table.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/space.hpp"

namespace rptv {

struct Correspondence {
  Point3 image{};   ///< where the light field puts it, mm
  Point3 object{};  ///< where it is, mm
};

/// Columns image_x, image_y, image_z, object_x, object_y, object_z (mm; others may follow), "-" is standard input.
/// Throws Error(bad_data, no_input, permission) with file and line. Set-up only.
std::vector<Correspondence> read_correspondences(const std::filesystem::path& file);
/// The same from text; `origin` stands for the file's name in messages.
std::vector<Correspondence> parse_correspondences(std::string_view text, const std::string& origin);

}  // namespace rptv
