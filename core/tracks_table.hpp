// SPDX-License-Identifier: MIT
// The table of particles followed: one row per track and frame.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/csv.hpp"
#include "core/tracks.hpp"

namespace rptv {

/// One row of a tracks table. Units mm, mm/s and s; `age` counts the frames in which it was seen before.
struct TrackRow {
  std::uint64_t frame = 0, particle = 0;
  double x_mm = 0, y_mm = 0, z_mm = 0;
  double vx_mm_s = 0, vy_mm_s = 0, vz_mm_s = 0;
  double residual_mm = 0;
  std::uint64_t age = 0;
  double t_s = 0;
};

/// Columns behind `t`.
struct TrackColumns {
  bool estimate = false;  ///< ax,ay,az and the covariances of position, velocity and acceleration; see docs/formats
};

/// "-" is standard output; write() never throws nor allocates, close() throws what went wrong.
class TracksWriter {
 public:
  explicit TracksWriter(const std::filesystem::path& file, TrackColumns columns = {});
  /// `estimate` may be null; without the columns for it, it is left out.
  void write(const TrackRow& row, const TrackEstimate* estimate = nullptr) noexcept;
  void write(std::uint64_t frame, double t_s, const Tracks& tracks) noexcept;
  CsvWriter& csv() noexcept { return csv_; }
  void close() { csv_.close(); }

 private:
  TrackColumns columns_;
  CsvWriter csv_;
};

/// "-" is standard input. Needs frame,particle,x,y,z (trackpy's output has them); what is absent stays 0, t NaN.
class TracksReader {
 public:
  explicit TracksReader(const std::filesystem::path& file) : csv_(file, columns()) {}
  static TracksReader from_text(std::string_view text, std::string origin) {
    return TracksReader(CsvReader::from_text(text, std::move(origin), columns()));
  }
  bool next(TrackRow& row);
  std::size_t line() const noexcept { return csv_.line(); }

 private:
  explicit TracksReader(CsvReader csv) : csv_(std::move(csv)) {}
  static std::vector<CsvColumn> columns();
  CsvReader csv_;
};

}  // namespace rptv
