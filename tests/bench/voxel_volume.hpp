// SPDX-License-Identifier: MIT
// A volume of intensities that a baseline reconstructs, the particles in it, and how well they fit the truth.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "reconstruct/light_field/ray_count_kernel.hpp"

namespace rptv::bench {

/// Intensity at the centre of every inner voxel of a grid, [y][x][z]: a ray stays in a column for many planes.
struct VoxelVolume {
  explicit VoxelVolume(const VoxelGrid& of)
      : grid(of),
        size{static_cast<std::size_t>(of.size_x), static_cast<std::size_t>(of.size_y),
             static_cast<std::size_t>(of.planes)},
        value(size[0] * size[1] * size[2]) {}
  std::size_t column(std::size_t x, std::size_t y) const { return (y * size[0] + x) * size[2]; }
  float at(std::size_t x, std::size_t y, std::size_t z) const { return value[column(x, y) + z]; }

  VoxelGrid grid;
  std::array<std::size_t, 3> size;  ///< x, y, z
  std::vector<float> value;
};

using Point = std::array<double, 3>;

/// The `most` brightest maxima among 26 neighbours, placed by a parabola along each axis; image space, mm.
std::vector<Point> brightest_maxima(const VoxelVolume& volume, std::size_t most);

struct Score {
  std::size_t found = 0, ghosts = 0;
  double mean_error_mm = 0, lateral_mm = 0;  ///< of those found: mean distance, mean distance aside
};

/// Pairs one-to-one, nearest first, within 0.25 mm aside and 3 mm in depth.
Score score_points(const std::vector<Point>& points, const std::vector<Point>& truth);

}  // namespace rptv::bench
