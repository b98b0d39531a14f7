// SPDX-License-Identifier: MIT
// The table of particles found: one row per particle and frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/csv.hpp"
#include "core/particles.hpp"

namespace rptv {

inline constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();

/// One row of a points table. Units mm and s.
struct PointRow {
  std::uint64_t frame = 0;
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double residual_mm = 0;
  double support = 0;
  Covariance covariance_mm2{};  ///< zero where the table has none
  double ghost = 0;             ///< probability that it is none; zero where the table has none
  double t_s = kNoTime;         ///< NaN where the table has no column t
};

/// The points of one frame.
struct PointFrame {
  std::uint64_t frame = 0;
  double t_s = kNoTime;
  std::vector<PointRow> points;
};

/// Columns behind `frame,x,y,z,residual,support`.
struct PointColumns {
  bool covariance = false;  ///< var_x,var_y,var_z,cov_xy,cov_xz,cov_yz
  bool ghost = false;       ///< ghost
  bool time = false;        ///< t
};

/// "-" is standard output. write() never throws nor allocates; close() throws what went wrong (see CsvWriter).
class PointsWriter {
 public:
  explicit PointsWriter(const std::filesystem::path& file, PointColumns columns = {});
  void write(const PointRow& row) noexcept;
  void write(std::uint64_t frame, double t_s, const Particles& particles) noexcept;
  CsvWriter& csv() noexcept { return csv_; }
  void close() { csv_.close(); }

 private:
  PointColumns columns_;
  CsvWriter csv_;
};

/// "-" is standard input. Needs frame,x,y; takes z (else 0), residual, support, covariance, ghost and t where they are
/// there. Frames must not decrease, and t must be one value per frame and increase with it: else Error(bad_data) names
/// the line.
class PointsReader {
 public:
  explicit PointsReader(const std::filesystem::path& file) : PointsReader(CsvReader(file, columns())) {}
  static PointsReader from_text(std::string_view text, std::string origin) {
    return PointsReader(CsvReader::from_text(text, std::move(origin), columns()));
  }
  /// The next frame that has points (frames without rows are not in the table); false at the end.
  bool next(PointFrame& frame);
  bool has_time() const noexcept;

 private:
  explicit PointsReader(CsvReader csv) : csv_(std::move(csv)) {}
  static std::vector<CsvColumn> columns();
  PointRow row() const;

  CsvReader csv_;
  std::optional<PointRow> pending_;  // first row of the frame to come
};

}  // namespace rptv
