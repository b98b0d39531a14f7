// SPDX-License-Identifier: MIT
// Reading of truth and measurement tables.
#include "simulation/truth.hpp"

#include <limits>

namespace rptv {

namespace {

enum Column : std::size_t { kFrame, kParticle, kX, kY, kZ, kVx, kVy, kVz, kResidual, kAge, kTime, kInView };

std::vector<CsvColumn> columns(bool need_particle) {
  return {{"frame"},
          {"particle", {"id"}, need_particle},
          {"x", {"X_mm", "x_mm"}},
          {"y", {"Y_mm", "y_mm"}},
          {"z", {"Z_mm", "z_mm"}},
          {"vx", {"VX_mm_s"}, false},
          {"vy", {"VY_mm_s"}, false},
          {"vz", {"VZ_mm_s"}, false},
          {"residual", {}, false},
          {"age", {}, false},
          {"t", {"t_s"}, false},
          {"in_view", {"footprint_fully_in_fov"}, false}};
}

void read_row(const CsvReader& csv, TrackRow& row) {
  const auto number = [&](std::size_t column) { return csv.has(column) ? csv.number(column) : 0.0; };
  row.frame = csv.index(kFrame);
  row.particle = csv.has(kParticle) ? csv.index(kParticle) : 0;
  row.x_mm = csv.number(kX);
  row.y_mm = csv.number(kY);
  row.z_mm = csv.number(kZ);
  row.vx_mm_s = number(kVx);
  row.vy_mm_s = number(kVy);
  row.vz_mm_s = number(kVz);
  row.residual_mm = number(kResidual);
  row.age = csv.has(kAge) ? csv.index(kAge) : 0;
  row.t_s = csv.has(kTime) ? csv.number_or_nan(kTime) : kNoTime;
}

std::vector<TruthRow> truth_of(CsvReader csv) {
  std::vector<TruthRow> rows;
  while (csv.next()) {
    TruthRow row;
    read_row(csv, row);
    row.in_view = !csv.has(kInView) || csv.index(kInView) != 0;
    rows.push_back(row);
  }
  return rows;
}

Measurement measurement_of(CsvReader csv) {
  Measurement measurement;
  measurement.linked = csv.has(kParticle);
  TrackRow row;
  while (csv.next()) {
    read_row(csv, row);
    measurement.rows.push_back(row);
  }
  return measurement;
}

}  // namespace

std::vector<TruthRow> read_truth(const std::filesystem::path& file) { return truth_of(CsvReader(file, columns(true))); }

std::vector<TruthRow> parse_truth(std::string_view text, const std::string& origin) {
  return truth_of(CsvReader::from_text(text, origin, columns(true)));
}

Measurement read_measurement(const std::filesystem::path& file) {
  return measurement_of(CsvReader(file, columns(false)));
}

Measurement parse_measurement(std::string_view text, const std::string& origin) {
  return measurement_of(CsvReader::from_text(text, origin, columns(false)));
}

}  // namespace rptv
