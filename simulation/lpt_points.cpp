// SPDX-License-Identifier: MIT
// Numbers between blanks, line by line.
#include "simulation/lpt_points.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/text_file.hpp"

namespace rptv {

namespace {

bool is_blank(char c) noexcept { return c == ' ' || c == '\t' || c == '\r' || c == ','; }

/// The numbers of one line; throws at what is none.
std::vector<double> numbers_of(std::string_view line, const std::string& where) {
  std::vector<double> values;
  for (std::size_t at = 0; at < line.size();) {
    if (is_blank(line[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < line.size() && !is_blank(line[end])) ++end;
    double value = 0;
    const auto [stop, error] = std::from_chars(line.data() + at, line.data() + end, value);
    if (error != std::errc() || stop != line.data() + end)
      throw Error(ExitCode::bad_data,
                  fmt::format("{}: {} is no number; mend it", where, in_quotes(line.substr(at, end - at))));
    values.push_back(value);
    at = end;
  }
  return values;
}

}  // namespace

std::vector<LptPoint> parse_lpt_points(std::string_view text, const std::string& origin) {
  std::vector<LptPoint> points;
  std::size_t number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r,");
    if (first == std::string_view::npos || line[first] == '#') continue;
    const auto initial = static_cast<unsigned char>(line[first]);
    if (points.empty() && std::isalpha(initial) != 0) continue;
    const std::string where = fmt::format("{}:{}", origin, number);
    const auto values = numbers_of(line, where);
    const std::size_t cameras = (values.size() - std::min<std::size_t>(values.size(), 3)) / 2;
    if (cameras == 0 || values.size() != 3 + 2 * cameras ||
        (!points.empty() && points.front().pixels.size() != cameras))
      throw Error(ExitCode::bad_data,
                  fmt::format("{}: has {} numbers; a line is X Y Z x1 y1 x2 y2 …, for as many cameras as the first",
                              where, values.size()));
    LptPoint point{{values[0], values[1], values[2]}, {}};
    if (!std::isfinite(values[0]) || !std::isfinite(values[1]) || !std::isfinite(values[2]))
      throw Error(ExitCode::bad_data, fmt::format("{}: a position is not finite; mend it", where));
    for (std::size_t k = 0; k < cameras; ++k) point.pixels.push_back({values[3 + 2 * k], values[4 + 2 * k]});
    points.push_back(std::move(point));
  }
  return points;
}

std::vector<LptPoint> read_lpt_points(const std::filesystem::path& file) {
  return parse_lpt_points(read_text_file(file, "give a file of the LPT challenge"), file.string());
}

std::string lpt_points_text(const std::vector<LptPoint>& points) {
  std::string text;
  for (const LptPoint& point : points) {
    text += fmt::format("{} {} {}", point.position_mm[0], point.position_mm[1], point.position_mm[2]);
    for (const Pixel& pixel : point.pixels) text += fmt::format(" {} {}", pixel[0], pixel[1]);
    text += '\n';
  }
  return text;
}

}  // namespace rptv
