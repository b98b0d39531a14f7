// SPDX-License-Identifier: MIT
// The table of correspondences, row by row.
#include "calibration/light_field/correspondences.hpp"

#include "core/csv_reader.hpp"

namespace rptv {

namespace {

std::vector<CsvColumn> columns() {
  return {{"image_x"}, {"image_y"}, {"image_z"}, {"object_x"}, {"object_y"}, {"object_z"}};
}

std::vector<Correspondence> read_all(CsvReader csv) {
  std::vector<Correspondence> pairs;
  constexpr double kFarthestMm = 1e5;
  while (csv.next()) {
    Correspondence pair;
    for (std::size_t k = 0; k < 3; ++k) pair.image[k] = csv.number(k), pair.object[k] = csv.number(3 + k);
    for (const auto& point : {pair.image, pair.object})
      for (const double value : point)
        if (!(value > -kFarthestMm && value < kFarthestMm)) csv.refuse("a position is beyond 100 m; give mm");
    pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace

std::vector<Correspondence> read_correspondences(const std::filesystem::path& file) {
  return read_all(CsvReader(file, columns()));
}

std::vector<Correspondence> parse_correspondences(std::string_view text, const std::string& origin) {
  return read_all(CsvReader::from_text(text, origin, columns()));
}

}  // namespace rptv
