// SPDX-License-Identifier: MIT
// Tracks as CSV: which column is what.
#include "core/tracks_table.hpp"

namespace rptv {
namespace {

enum TrackColumn : std::size_t {
  kTrackFrame,
  kParticle,
  kTrackX,
  kTrackY,
  kTrackZ,
  kVx,
  kVy,
  kVz,
  kTrackResidual,
  kAge,
  kTime
};

std::string track_header(TrackColumns columns) {
  std::string header = "frame,particle,x,y,z,vx,vy,vz,residual,age,t";
  if (!columns.estimate) return header;
  header += ",ax,ay,az";
  for (const std::string of : {"", "v", "a"}) {
    for (const char* axis : {"x", "y", "z"}) header += ",var_" + of + axis;
    for (const char* axes : {"xy", "xz", "yz"}) header += ",cov_" + of + axes;
  }
  return header;
}

}  // namespace

TracksWriter::TracksWriter(const std::filesystem::path& file, TrackColumns columns)
    : columns_(columns), csv_(file, track_header(columns)) {}

void TracksWriter::write(const TrackRow& row, const TrackEstimate* estimate) noexcept {
  csv_.index(row.frame).index(row.particle).number(row.x_mm).number(row.y_mm).number(row.z_mm);
  csv_.number(row.vx_mm_s).number(row.vy_mm_s).number(row.vz_mm_s).number(row.residual_mm);
  csv_.index(row.age).number(row.t_s);
  if (columns_.estimate) {
    static constexpr TrackEstimate kNothing;
    const TrackEstimate& e = estimate != nullptr ? *estimate : kNothing;
    csv_.number(e.ax_mm_s2).number(e.ay_mm_s2).number(e.az_mm_s2);
    for (const Covariance* c : {&e.position_mm2, &e.velocity_mm2_s2, &e.acceleration_mm2_s4})
      for (const std::size_t i : {0U, 3U, 5U, 1U, 2U, 4U}) csv_.number((*c)[i]);  // variances first, as in points
  }
  csv_.end_row();
}

void TracksWriter::write(std::uint64_t frame, double t_s, const Tracks& tracks) noexcept {
  for (std::size_t i = 0; i < tracks.size(); ++i)
    write({frame, tracks.particle[i], tracks.x_mm[i], tracks.y_mm[i], tracks.z_mm[i], tracks.vx_mm_s[i],
           tracks.vy_mm_s[i], tracks.vz_mm_s[i], tracks.residual_mm[i], tracks.age_frames[i], t_s},
          tracks.estimate.empty() ? nullptr : &tracks.estimate[i]);
}

std::vector<CsvColumn> TracksReader::columns() {
  return {{"frame"},
          {"particle"},
          {"x", {"x_mm"}},
          {"y", {"y_mm"}},
          {"z", {"z_mm"}},
          {"vx", {"vx_mm_s"}, false},
          {"vy", {"vy_mm_s"}, false},
          {"vz", {"vz_mm_s"}, false},
          {"residual", {"residual_mm"}, false},
          {"age", {"age_frames"}, false},
          {"t", {"t_s"}, false}};
}

bool TracksReader::next(TrackRow& row) {
  if (!csv_.next()) return false;
  const auto optional = [&](std::size_t column, double absent) {
    return csv_.has(column) ? csv_.number(column) : absent;
  };
  row.frame = csv_.index(kTrackFrame);
  row.particle = csv_.index(kParticle);
  row.x_mm = csv_.number(kTrackX);
  row.y_mm = csv_.number(kTrackY);
  row.z_mm = csv_.number(kTrackZ);
  row.vx_mm_s = optional(kVx, 0);
  row.vy_mm_s = optional(kVy, 0);
  row.vz_mm_s = optional(kVz, 0);
  row.residual_mm = optional(kTrackResidual, 0);
  row.age = csv_.has(kAge) ? csv_.index(kAge) : 0;
  row.t_s = optional(kTime, std::numeric_limits<double>::quiet_NaN());
  return true;
}

}  // namespace rptv
