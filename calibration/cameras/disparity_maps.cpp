// SPDX-License-Identifier: MIT
// Sorts votes into their camera's map of their part of the volume.
#include "calibration/cameras/disparity_maps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/cameras/median.hpp"
#include "core/error.hpp"

namespace rptv {

std::optional<std::size_t> DisparityGrid::part_of(const Point3& point_mm) const noexcept {
  std::size_t part = 0;
  for (std::size_t k = 3; k-- > 0;) {
    const double along = (point_mm[k] - from_mm[k]) / (to_mm[k] - from_mm[k]);
    if (!(along >= 0 && along <= 1)) return {};
    const auto cut = static_cast<std::size_t>(along * static_cast<double>(parts[k]));
    part = part * parts[k] + std::min(cut, parts[k] - 1);
  }
  return part;
}

Point3 DisparityGrid::centre_mm(std::size_t part) const noexcept {
  Point3 centre{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double along = (static_cast<double>(part % parts[k]) + 0.5) / static_cast<double>(parts[k]);
    centre[k] = from_mm[k] + along * (to_mm[k] - from_mm[k]);
    part /= parts[k];
  }
  return centre;
}

DisparityMaps::DisparityMaps(const DisparityGrid& grid, std::size_t cameras, double radius_px)
    : grid_(grid), cameras_(cameras) {
  for (std::size_t k = 0; k < 3; ++k)
    if (!(grid.from_mm[k] < grid.to_mm[k]) || grid.parts[k] == 0 || grid.parts[k] > kMostParts)
      throw Error(ExitCode::usage,
                  fmt::format("{} parts of {} from {} to {} mm are no grid; give 1 to {} parts of a box with volume",
                              grid.parts[k], "xyz"[k], grid.from_mm[k], grid.to_mm[k], kMostParts));
  if (grid.size() > kMostParts)
    throw Error(ExitCode::usage, fmt::format("a grid of {} parts; give {} at most: each needs its own particles",
                                             grid.size(), kMostParts));
  maps_.assign(grid.size() * cameras, DisparityMap(radius_px));
  positions_.resize(grid.size());
}

void DisparityMaps::add(std::size_t camera, const Point3& position_mm, const Pixel& disparity_px) noexcept {
  const auto part = grid_.part_of(position_mm);
  if (!part) {
    ++outside_;
    return;
  }
  if (!maps_[*part * cameras_ + camera].add(disparity_px)) return;
  auto& sum = positions_[*part];
  for (std::size_t k = 0; k < 3; ++k) sum[k] += position_mm[k];
  ++sum[3];
}

void DisparityMaps::fade(double factor) noexcept {
  for (DisparityMap& map : maps_) map.fade(factor);
  for (auto& sum : positions_)
    for (double& value : sum) value *= factor;
  outside_ *= factor;
}

std::optional<DisparityPeak> DisparityMaps::peak(std::size_t camera, std::size_t part) const {
  return maps_[part * cameras_ + camera].peak();
}

Point3 DisparityMaps::middle_mm(std::size_t part) const noexcept {
  const auto& sum = positions_[part];
  if (!(sum[3] > 0)) return grid_.centre_mm(part);
  return {sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3]};
}

double DisparityMaps::outside() const noexcept {
  double outside = outside_;
  for (const DisparityMap& map : maps_) outside += map.outside();
  return outside;
}

CameraDisparity DisparityMaps::summary(std::size_t camera) const {
  CameraDisparity summary;
  std::vector<double> lengths;
  for (std::size_t part = 0; part < grid_.size(); ++part) {
    const auto found = peak(camera, part);
    if (!found) continue;
    const double length_px = std::hypot(found->at_px[0], found->at_px[1]);
    if (lengths.empty() || length_px > summary.worst_px)
      summary.worst_px = length_px, summary.worst_at_mm = middle_mm(part);
    lengths.push_back(length_px);
    summary.votes += found->votes;
  }
  summary.parts = lengths.size();
  summary.median_px = median(std::move(lengths));
  return summary;
}

}  // namespace rptv
