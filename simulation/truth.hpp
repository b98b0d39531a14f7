// SPDX-License-Identifier: MIT
// Tables that a score compares: what really was there, and what was measured (points or tracks).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/tables.hpp"

namespace rptv {

/// One row of a truth table: a tracks table with the column `in_view` behind it.
struct TruthRow : TrackRow {
  bool in_view = true;  ///< its whole image lies on the sensor: a reconstruction is expected to find it
};

/// A points table (linked: false, particle: 0) or a tracks table; rows by frame, not decreasing.
struct Measurement {
  std::vector<TrackRow> rows;
  bool linked = false;
};

/// Reads a truth table. A table without `in_view` (or `footprint_fully_in_fov`) counts every row as in view. Throws
/// Error (no_input, bad_data). Batch commands only.
std::vector<TruthRow> read_truth(const std::filesystem::path& file);
std::vector<TruthRow> parse_truth(std::string_view text, const std::string& origin);

/// Reads a tracks table, or a points table when it has no column `particle`. "-" is standard input. Errors as above; t
/// is NaN where the table has none.
Measurement read_measurement(const std::filesystem::path& file);
Measurement parse_measurement(std::string_view text, const std::string& origin);

}  // namespace rptv
