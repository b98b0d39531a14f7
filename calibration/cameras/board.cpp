// SPDX-License-Identifier: MIT
// Boards from TOML, and points from text.
#include "calibration/cameras/board.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"

namespace rptv {

namespace {

constexpr std::size_t kMostPoints = 100'000;

}  // namespace

void Board::fields(FieldList& list) {
  list.choice("kind", kind, {"charuco", "dots", "points"}, "how the target is recognised in an image").required = true;
  list.integer("columns", columns, 0, 1000, "squares (charuco) or dots along x");
  list.integer("rows", rows, 0, 1000, "the same along y");
  list.number("square_mm", square_mm, 0, 1e5, "side of a square, or distance of neighbouring dots");
  list.number("marker_mm", marker_mm, 0, 1e5, "charuco: side of a marker");
  std::vector<std::string> sets;
  for (const auto& set : kMarkerSets) sets.emplace_back(set.name);
  list.choice("dictionary", dictionary, sets, "charuco: the set of markers");
  list.text("points_file", points_file, "points: text file with `id x y z` (mm) in each line");
}

std::vector<Point3> Board::points() const {
  if (kind == "points") return known_mm;
  std::vector<Point3> all;
  const bool squares = kind == "charuco";
  const std::int64_t across = squares ? columns - 1 : columns, down = squares ? rows - 1 : rows;
  for (std::int64_t row = 0; row < down; ++row)
    for (std::int64_t column = 0; column < across; ++column) {
      const std::int64_t first = squares ? 1 : 0;
      all.push_back({square_mm * static_cast<double>(column + first), square_mm * static_cast<double>(row + first), 0});
    }
  return all;
}

std::size_t marker_set_of(const std::string& dictionary) {
  const auto* at = std::find_if(std::begin(kMarkerSets), std::end(kMarkerSets),
                                [&](const MarkerSet& set) { return dictionary == set.name; });
  return static_cast<std::size_t>(at - std::begin(kMarkerSets));
}

bool is_flat(const std::vector<Point3>& points) {
  constexpr double kFlat = 1e-3;  // of the largest extent
  Point3 across{}, normal{};      // of the largest triangle with the first point and the one farthest from it
  for (const auto& p : points)
    if (norm(p - points[0]) > norm(across)) across = p - points[0];
  for (const auto& p : points)
    if (const Point3 n = cross(across, p - points[0]); norm(n) > norm(normal)) normal = n;
  return std::all_of(points.begin(), points.end(), [&](const Point3& p) {
    return std::abs(dot(normal, p - points[0])) <= kFlat * norm(across) * norm(normal);
  });
}

void Board::validate(const std::string& origin) const {
  const auto refuse = [&](const std::string& text) {
    throw Error(ExitCode::configuration, fmt::format("{}: {}", origin, text));
  };
  if (kind == "points") {
    if (known_mm.size() < 8)
      refuse(fmt::format("the target has {} known points; a camera needs at least 8", known_mm.size()));
    if (is_flat(known_mm) && std::any_of(known_mm.begin(), known_mm.end(), [](const Point3& p) { return p[2] != 0; }))
      refuse("all known points lie in one plane; give them with z = 0");
    return;
  }
  if (columns < 3 || rows < 3)
    refuse(fmt::format("columns = {} and rows = {}; a {} board has at least 3 of each", columns, rows, kind));
  if (!(square_mm > 0)) refuse("square_mm is missing; measure the printed board and give it");
  if (kind == "charuco" && !(marker_mm > 0 && marker_mm < square_mm))
    refuse(fmt::format("marker_mm = {} is not between 0 and square_mm = {}; measure both", marker_mm, square_mm));
  if (kind == "charuco" && columns * rows / 2 > kMarkerSets[marker_set_of(dictionary)].markers)
    refuse(fmt::format("{} x {} squares hold {} markers and {} has {}; name the set that was printed", columns, rows,
                       columns * rows / 2, dictionary, kMarkerSets[marker_set_of(dictionary)].markers));
  if (kind == "dots" && columns == rows)
    refuse(
        fmt::format("columns and rows are both {}, so a turn by a right angle cannot be seen; cover one row or "
                    "use a charuco board",
                    columns));
}

Board read_board(const std::filesystem::path& file) {
  Board board;
  FieldList list;
  board.fields(list);
  read_toml_file(file, "board", Board::kSchema, list);
  if (board.kind == "points") {
    if (board.points_file.empty())
      throw Error(ExitCode::configuration,
                  fmt::format("{}: points_file is missing; name the text file with `id x y z` lines", file.string()));
    auto known = read_numbered_points(file.parent_path() / board.points_file, 3);
    board.ids = std::move(known.ids), board.known_mm = std::move(known.values);
  }
  board.validate(file.string());
  return board;
}

NumberedPoints read_numbered_points(const std::filesystem::path& file, std::size_t numbers) {
  std::ifstream stream(file);
  if (!stream) throw Error(ExitCode::no_input, fmt::format("{}: cannot be opened; check the name", file.string()));
  NumberedPoints found;
  std::set<std::int64_t> seen;
  std::string line;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    const auto refuse = [&](const std::string& text) {
      throw Error(ExitCode::bad_data, fmt::format("{}:{}: {}", file.string(), number, text));
    };
    line.erase(std::min(line.find('#'), line.size()));
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::int64_t id = 0;
    Point3 value{};
    if (std::string first; !(words >> first)) continue;
    words.clear(), words.seekg(0);
    words >> id;
    for (std::size_t k = 0; k < numbers; ++k) words >> value.at(k);
    if (!words || !std::isfinite(norm(value)))
      refuse(fmt::format("{} is not an id and {} numbers; write them so", in_quotes(line), numbers));
    if (!seen.insert(id).second) refuse(fmt::format("id {} is there twice; number the points once each", id));
    if (found.ids.size() == kMostPoints) refuse(fmt::format("more than {} points; this is no target", kMostPoints));
    found.ids.push_back(id), found.values.push_back(value);
  }
  if (found.ids.empty())
    throw Error(ExitCode::bad_data,
                fmt::format("{}: has no points; write `id` and {} numbers in each line", file.string(), numbers));
  return found;
}

}  // namespace rptv
