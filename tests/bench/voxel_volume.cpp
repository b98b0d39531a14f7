// SPDX-License-Identifier: MIT
// Maxima of a volume and their score.
#include "tests/bench/voxel_volume.hpp"

#include <algorithm>
#include <cmath>

#include "tests/reconstruct/shared_data.hpp"

namespace rptv::bench {

namespace {

struct Maximum {
  float value;
  std::size_t x, y, z;
};

bool is_maximum(const VoxelVolume& v, std::size_t x, std::size_t y, std::size_t z) {
  const float self = v.at(x, y, z);
  for (std::size_t j = y - 1; j <= y + 1; ++j)
    for (std::size_t i = x - 1; i <= x + 1; ++i)
      for (std::size_t k = z - 1; k <= z + 1; ++k) {
        const float other = v.at(i, j, k);
        const bool earlier = j != y ? j < y : i != x ? i < x : k < z;
        if (other > self || (other == self && earlier)) return false;
      }
  return true;
}

// Vertex of the parabola through three values at -1, 0, 1; the middle one is the highest.
double vertex(double before, double middle, double after) {
  const double bend = before - 2 * middle + after;
  return bend < 0 ? std::clamp(0.5 * (before - after) / bend, -0.5, 0.5) : 0;
}

}  // namespace

std::vector<Point> brightest_maxima(const VoxelVolume& v, std::size_t most) {
  std::vector<Maximum> maxima;
  const float least = 1e-3F * *std::max_element(v.value.begin(), v.value.end());
  for (std::size_t y = 1; y + 1 < v.size[1]; ++y)
    for (std::size_t x = 1; x + 1 < v.size[0]; ++x)
      for (std::size_t z = 1; z + 1 < v.size[2]; ++z)
        if (v.at(x, y, z) > least && is_maximum(v, x, y, z)) maxima.push_back({v.at(x, y, z), x, y, z});
  std::sort(maxima.begin(), maxima.end(), [](const Maximum& a, const Maximum& b) { return a.value > b.value; });
  maxima.resize(std::min(maxima.size(), most));
  std::vector<Point> points;
  for (const auto& [value, x, y, z] : maxima) {
    const double dx = vertex(v.at(x - 1, y, z), value, v.at(x + 1, y, z));
    const double dy = vertex(v.at(x, y - 1, z), value, v.at(x, y + 1, z));
    const double dz = vertex(v.at(x, y, z - 1), value, v.at(x, y, z + 1));
    points.push_back({v.grid.first_x_mm + (static_cast<double>(x) + dx) * v.grid.step_x_mm,
                      v.grid.first_y_mm + (static_cast<double>(y) + dy) * v.grid.step_y_mm,
                      v.grid.first_z_mm + (static_cast<double>(z) + dz) * v.grid.step_z_mm});
  }
  return points;
}

Score score_points(const std::vector<Point>& points, const std::vector<Point>& truth) {
  Particles particles(points.size());
  for (const auto& p : points) particles.push({p[0], p[1], p[2], 0, 0, {}});
  const auto matches = testing::match(particles, truth, 0.25, 3);
  Score score{matches.size(), points.size() - matches.size(), 0, 0};
  for (const auto& [found, true_one] : matches) {
    const auto &a = points[found], &b = truth[true_one];
    score.mean_error_mm += std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / static_cast<double>(matches.size());
    score.lateral_mm += std::hypot(a[0] - b[0], a[1] - b[1]) / static_cast<double>(matches.size());
  }
  return score;
}

}  // namespace rptv::bench
