// SPDX-License-Identifier: MIT
// A calibration target: points whose places on it are known, and how an image of it is recognised.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "calibration/space.hpp"
#include "core/settings.hpp"

namespace rptv {

/// A plain value. `points()` are in the target's own frame, mm; a point's number is its place in that list.
struct Board {
  static constexpr std::int64_t kSchema = 1;

  std::string kind = "charuco";             ///< "charuco", "dots" (a plain grid), or "points" (any known points)
  std::int64_t columns = 0;                 ///< squares, or dots, along x
  std::int64_t rows = 0;                    ///< the same along y
  double square_mm = 0;                     ///< charuco: side of a square; dots: distance of neighbours
  double marker_mm = 0;                     ///< charuco: side of a marker
  std::string dictionary = "DICT_5X5_100";  ///< charuco: OpenCV's name of the set of markers
  std::string points_file;                  ///< points: text, `id x y z` a line, relative to the board's file
  std::vector<std::int64_t> ids{};          ///< points: the number that the file gives to each
  std::vector<Point3> known_mm{};           ///< points: read from the file

  void fields(FieldList& list);
  /// charuco: the inner corners, row by row as OpenCV numbers them (4.6 and before, "legacy"); dots: row by row.
  std::vector<Point3> points() const;
  /// Throws Error(configuration) when it cannot be built. `origin` stands for the file's name.
  void validate(const std::string& origin) const;
};

/// A set of markers that OpenCV has.
struct MarkerSet {
  const char* name;
  std::int64_t markers;
};
/// In OpenCV's order: the place is its number of the set.
inline constexpr MarkerSet kMarkerSets[] = {
    {"DICT_4X4_50", 50},          {"DICT_4X4_100", 100}, {"DICT_4X4_250", 250}, {"DICT_4X4_1000", 1000},
    {"DICT_5X5_50", 50},          {"DICT_5X5_100", 100}, {"DICT_5X5_250", 250}, {"DICT_5X5_1000", 1000},
    {"DICT_6X6_50", 50},          {"DICT_6X6_100", 100}, {"DICT_6X6_250", 250}, {"DICT_6X6_1000", 1000},
    {"DICT_7X7_50", 50},          {"DICT_7X7_100", 100}, {"DICT_7X7_250", 250}, {"DICT_7X7_1000", 1000},
    {"DICT_ARUCO_ORIGINAL", 1024}};
/// Place of a board's set in kMarkerSets.
std::size_t marker_set_of(const std::string& dictionary);

/// All points in one plane, so that one view cannot tell distance from focal length.
bool is_flat(const std::vector<Point3>& points);

/// Reads a board's TOML file and, for "points", the points' file. Throws Error(configuration, no_input, bad_data).
Board read_board(const std::filesystem::path& file);

/// Rows of a text file `id a b [c]`, `numbers` after the id; blanks, tabs or commas between, `#` begins a remark.
/// Throws Error(no_input, bad_data) with file and line: not a number, too few, an id twice, no row at all.
struct NumberedPoints {
  std::vector<std::int64_t> ids;
  std::vector<Point3> values;  ///< the third is 0 when `numbers` is 2
};
NumberedPoints read_numbered_points(const std::filesystem::path& file, std::size_t numbers);

}  // namespace rptv
