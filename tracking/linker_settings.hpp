// SPDX-License-Identifier: MIT
// What the user chooses about linking particles into tracks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

/// Names follow trackpy where it has one; fields() says what each is for. Memory of the linker grows with max_tracks ×
/// max_candidates, but only where frames need it.
struct LinkerSettings {
  double search_range_mm = 0.5;
  std::vector<double> search_range_xyz_mm{0, 0, 0};
  std::int64_t memory = 3;
  std::string predict = "none";
  std::string start_up = "nearest";
  double model_error_mm = 0;
  double noise_mm = 0;
  double gate_sigma = 0;
  double flow_bin_mm = 0;
  double adaptive_stop_mm = 0;
  double adaptive_step = 0.95;
  std::int64_t max_subnet = 0;
  double deadline_ms = 50;
  std::int64_t max_particles = 20'000;
  std::int64_t max_tracks = 32'000;
  std::int64_t max_candidates = 32;

  /// Half-axes of the ellipsoid that is searched, mm.
  std::array<double, 3> range_mm() const noexcept;
  /// Tracks are Kalman-filtered: they have acceleration and covariance.
  bool filters() const noexcept { return predict == "kalman" || predict == "kalman_acceleration"; }
  /// Throws Error(configuration) for values out of range or that contradict each other.
  void check() const;
  void fields(FieldList& list);
};

}  // namespace rptv
