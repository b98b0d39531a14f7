// SPDX-License-Identifier: MIT
// The integral on a grid over the volume, summed over the subsets of views.
#include "reconstruct/multi_view/matches_by_chance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "calibration/space_algebra.hpp"

namespace rptv {

namespace {

constexpr int kGrid = 6, kFineGrid = 16;  // points along each axis of the volume
constexpr int kColumns = 16, kRows = 12;  // fields of an image

/// Calls `visit` with the middles of grid³ parts of the volume.
template <class Visit>
void for_parts(const Volume& volume, int grid, const Visit& visit) {
  for (int i = 0; i < grid * grid * grid; ++i) {
    const std::array<int, 3> at{i % grid, i / grid % grid, i / grid / grid};
    Point3 point{};
    for (std::size_t k = 0; k < 3; ++k)
      point[k] = volume.from[k] + (volume.to[k] - volume.from[k]) * (at[k] + 0.5) / grid;
    visit(point);
  }
}

/// Share of the particles of an evenly filled volume that a camera sees in a square pixel, by fields of its image.
class SeenDensity {
 public:
  SeenDensity(const CameraModel& camera, const Volume& volume) : camera_(&camera), shares_(kColumns * kRows, 0) {
    double seen = 0;
    for_parts(volume, kFineGrid, [&](const Point3& point) {
      const auto at = camera.project(point);
      if (at && camera.in_image(*at)) ++shares_[field_of(*at)], ++seen;
    });
    const auto& lens = camera.intrinsics();
    const double field_px2 = static_cast<double>(lens.width_px) * lens.height_px / (kColumns * kRows);
    for (double& share : shares_) share /= std::max(seen, 1.0) * field_px2;
  }
  double at(const Pixel& pixel) const { return shares_[field_of(pixel)]; }

 private:
  std::size_t field_of(const Pixel& pixel) const {
    const auto& lens = camera_->intrinsics();
    const int column = static_cast<int>((pixel[0] + 0.5) * kColumns / lens.width_px);
    const int row = static_cast<int>((pixel[1] + 0.5) * kRows / lens.height_px);
    return static_cast<std::size_t>(row * kColumns + column);
  }
  const CameraModel* camera_;
  std::vector<double> shares_;
};

/// One view's share of JᵀJ, px²/mm², and how many detections it has in a square pixel there.
struct PointView {
  Matrix3 square{};
  double density = 0;
};

/// Sum of √det(JᵀJ) times the densities, over the subsets of `views` more of `sights` from `first` on.
double sum_over_subsets(const std::vector<PointView>& sights, std::size_t first, std::size_t views,
                        const Matrix3& square, double density) {
  if (views == 0) return density * std::sqrt(std::max(determinant(square), 0.0));
  double sum = 0;
  for (std::size_t v = first; v + views <= sights.size(); ++v) {
    Matrix3 with = square;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) with[i][k] += sights[v].square[i][k];
    sum += sum_over_subsets(sights, v + 1, views - 1, with, density * sights[v].density);
  }
  return sum;
}

double ball_volume(std::size_t dimensions, double radius) {
  const double half = 0.5 * static_cast<double>(dimensions);
  return std::pow(std::numbers::pi, half) / std::tgamma(half + 1) * std::pow(radius, 2 * half);
}

}  // namespace

double matches_by_chance(const Rig& rig, const Volume& volume, std::size_t detections, std::size_t min_views,
                         double tolerance_px) {
  std::vector<SeenDensity> densities;
  for (const RigCamera& camera : rig.cameras) densities.emplace_back(camera.model, volume);
  double sum = 0;
  for_parts(volume, kGrid, [&](const Point3& point) {
    std::vector<PointView> sights;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      PixelJacobian by_point;
      const auto at = rig.cameras[c].model.project(point, by_point);
      if (!at || !rig.cameras[c].model.in_image(*at)) continue;
      PointView& sight = sights.emplace_back();
      sight.density = static_cast<double>(detections) * densities[c].at(*at);
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          sight.square[i][k] = by_point[0][i] * by_point[0][k] + by_point[1][i] * by_point[1][k];
    }
    sum += sum_over_subsets(sights, 0, min_views, {}, 1);
  });
  const Point3 size = volume.to - volume.from;
  const double part_mm3 = size[0] * size[1] * size[2] / (kGrid * kGrid * kGrid);
  const double radius = std::sqrt(static_cast<double>(min_views)) * tolerance_px;
  return sum * part_mm3 * ball_volume(2 * min_views - 3, radius);
}

}  // namespace rptv
