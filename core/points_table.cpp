// SPDX-License-Identifier: MIT
// Points as CSV: which column is what, and how rows make frames.
#include "core/points_table.hpp"

namespace rptv {
namespace {

enum PointColumn : std::size_t { kFrame, kX, kY, kZ, kResidual, kSupport, kVarX, kGhost = kVarX + 6, kT };

/// Covariance stores xx, xy, xz, yy, yz, zz; the table writes variances first.
constexpr std::size_t kCovarianceOrder[6] = {0, 3, 5, 1, 2, 4};

std::string point_header(PointColumns columns) {
  std::string header = "frame,x,y,z,residual,support";
  if (columns.covariance) header += ",var_x,var_y,var_z,cov_xy,cov_xz,cov_yz";
  if (columns.ghost) header += ",ghost";
  if (columns.time) header += ",t";
  return header;
}

}  // namespace

PointsWriter::PointsWriter(const std::filesystem::path& file, PointColumns columns)
    : columns_(columns), csv_(file, point_header(columns)) {}

void PointsWriter::write(const PointRow& row) noexcept {
  csv_.index(row.frame).number(row.x_mm).number(row.y_mm).number(row.z_mm).number(row.residual_mm).number(row.support);
  if (columns_.covariance)
    for (const std::size_t i : kCovarianceOrder) csv_.number(row.covariance_mm2[i]);
  if (columns_.ghost) csv_.number(row.ghost);
  if (columns_.time) csv_.number(row.t_s);
  csv_.end_row();
}

void PointsWriter::write(std::uint64_t frame, double t_s, const Particles& particles) noexcept {
  for (std::size_t i = 0; i < particles.size(); ++i)
    write({frame, particles.x_mm[i], particles.y_mm[i], particles.z_mm[i], particles.residual_mm[i],
           particles.support[i], particles.covariance_mm2[i], particles.ghost[i], t_s});
}

std::vector<CsvColumn> PointsReader::columns() {
  std::vector<CsvColumn> list = {{"frame"}, {"x", {"x_mm"}}, {"y", {"y_mm"}}, {"z", {"z_mm"}, false}};
  list.push_back({"residual", {"residual_mm"}, false});
  list.push_back({"support", {}, false});
  for (const char* name : {"var_x", "var_y", "var_z", "cov_xy", "cov_xz", "cov_yz"}) list.push_back({name, {}, false});
  list.push_back({"ghost", {}, false});
  list.push_back({"t", {"t_s"}, false});
  return list;
}

bool PointsReader::has_time() const noexcept { return csv_.has(kT); }

PointRow PointsReader::row() const {
  PointRow row;
  row.frame = csv_.index(kFrame);
  row.x_mm = csv_.number(kX);
  row.y_mm = csv_.number(kY);
  if (csv_.has(kZ)) row.z_mm = csv_.number(kZ);  // tables of the plane have none
  if (csv_.has(kResidual)) row.residual_mm = csv_.number(kResidual);
  if (csv_.has(kSupport)) row.support = csv_.number(kSupport);
  for (std::size_t i = 0; i < 6; ++i)
    if (csv_.has(kVarX + i)) row.covariance_mm2[kCovarianceOrder[i]] = csv_.number(kVarX + i);
  if (csv_.has(kGhost)) row.ghost = csv_.number(kGhost);
  if (csv_.has(kT)) row.t_s = csv_.number(kT);
  return row;
}

bool PointsReader::next(PointFrame& frame) {
  if (!pending_) {
    if (!csv_.next()) return false;
    pending_ = row();
  }
  frame.frame = pending_->frame;
  frame.t_s = pending_->t_s;
  frame.points.assign(1, *pending_);
  pending_.reset();
  while (csv_.next()) {
    const PointRow point = row();
    if (point.frame < frame.frame)
      csv_.refuse("frame " + std::to_string(point.frame) + " comes after frame " + std::to_string(frame.frame) +
                  "; sort the rows by frame");
    const bool same_frame = point.frame == frame.frame;
    if (has_time() && same_frame && point.t_s != frame.t_s)
      csv_.refuse("two times t in frame " + std::to_string(frame.frame) + "; a frame has one time, in s");
    if (has_time() && !same_frame && point.t_s <= frame.t_s)
      csv_.refuse("t does not increase from frame " + std::to_string(frame.frame) + " to frame " +
                  std::to_string(point.frame) + "; mend the times or remove the column t");
    if (!same_frame) {
      pending_ = point;
      break;
    }
    frame.points.push_back(point);
  }
  return true;
}

}  // namespace rptv
