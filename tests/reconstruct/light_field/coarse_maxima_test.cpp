// SPDX-License-Identifier: MIT
// Candidates of the coarse count against their definition, and against every voxel of the full count.
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <random>

#include "reconstruct/light_field/coarse_maxima.hpp"

namespace rptv {
namespace {

VoxelGrid unit_grid(int x, int y, int planes, float step_z, float first_z) {
  VoxelGrid grid;
  grid.size_x = x, grid.size_y = y, grid.planes = planes, grid.step_z_mm = step_z, grid.first_z_mm = first_z;
  return grid;
}

// Rays of slopes up to 0.1 through points of the box that has its corner at (0, 0, -20) and 40 of depth.
Rays rays_through(int points, int rays_each, double half_x, double half_y, unsigned seed) {
  Rays rays(static_cast<std::size_t>(points * rays_each), 1);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t i = 0; i < rays.capacity();) {
    const double x = 2 * half_x * unit(random), y = 2 * half_y * unit(random), z = 40 * (unit(random) - 0.5);
    for (int k = 0; k < rays_each; ++k, ++i) {
      const double s = 0.2 * (unit(random) - 0.5), t = 0.2 * (unit(random) - 0.5);
      rays.ray[i] = {static_cast<float>(x + unit(random) - 0.5 - s * z), static_cast<float>(y - t * z),
                     static_cast<float>(s), static_cast<float>(t)};
    }
  }
  rays.size = rays.pixels = rays.capacity();
  return rays;
}

// 1-2-1 weighted counts round a voxel, inner voxels only.
int weighted(const RayCounter& counter, int x, int y, int z) {
  const auto& grid = counter.grid();
  int sum = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const bool inside = x + i >= 1 && y + j >= 1 && x + i <= grid.size_x && y + j <= grid.size_y;
      if (inside) sum += (2 - std::abs(i)) * (2 - std::abs(j)) * std::min<int>(counter.at(x + i, y + j, z), 4095);
    }
  return sum;
}

bool beaten(const RayCounter& counter, int x, int y, int z) {
  const auto& grid = counter.grid();
  const int self = weighted(counter, x, y, z);
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i) {
        if (x + i < 1 || y + j < 1 || x + i > grid.size_x || y + j > grid.size_y || z + k < 0 || z + k >= grid.planes)
          continue;
        const int other = weighted(counter, x + i, y + j, z + k);
        const bool earlier = k != 0 ? k < 0 : j != 0 ? j < 0 : i < 0;
        if (other > self || (other == self && earlier)) return true;
      }
  return false;
}

double highest_near(const RayCounter& counter, int x, int y, int z) {
  int highest = 0;
  for (int j = std::max(y - 1, 1); j <= std::min(y + 1, counter.grid().size_y); ++j)
    for (int i = std::max(x - 1, 1); i <= std::min(x + 1, counter.grid().size_x); ++i)
      highest = std::max(highest, weighted(counter, i, j, z));
  return highest;
}

// Where a parabola through the three planes has its vertex, at most half a plane off.
double depth_of(const RayCounter& counter, int x, int y, int z) {
  if (z == 0 || z + 1 == counter.grid().planes) return z;
  const double before = highest_near(counter, x, y, z - 1), here = highest_near(counter, x, y, z),
               after = highest_near(counter, x, y, z + 1), bend = before - 2 * here + after;
  return bend < 0 ? z + std::clamp(0.5 * (before - after) / bend, -0.49, 0.49) : z;
}

RC_GTEST_PROP(CoarseMaxima, are_those_of_their_definition, ()) {
  using rc::gen::inRange;
  const auto grid = unit_grid(*inRange(1, 40), *inRange(1, 30), *inRange(1, 6), 9, -18);
  const Rays rays = rays_through(*inRange(1, 25), 50, grid.size_x / 2.0, grid.size_y / 2.0, *inRange(0U, 1U << 30));
  const auto least = *inRange<std::uint16_t>(1, 60);
  RayCounter counter(grid, rays.capacity(), 1);
  counter.count(rays, {}, least);
  std::vector<std::array<float, 3>> expected;
  for (int z = 0; z < grid.planes; ++z)
    for (int y = 1; y <= grid.size_y; ++y)
      for (int x = 1; x <= grid.size_x; ++x) {
        const Candidate here = candidate_at(counter, x, y, depth_of(counter, x, y, z));
        if (weighted(counter, x, y, z) >= least && here.rays >= least && !beaten(counter, x, y, z))
          expected.push_back({here.x_mm, here.y_mm, here.z_mm});
      }
  for (const auto set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
    if (set > best_instruction_set()) continue;
    CoarseMaxima maxima(grid, 2, set);
    std::vector<Candidate> found;
    found.reserve(10000);
    for (int repeat = 0; repeat < 2; ++repeat) {
      found.clear();
      RC_ASSERT(maxima.find(counter, least, found) == 0U);
      RC_ASSERT(found.size() == expected.size());
      for (std::size_t i = 0; i < found.size(); ++i)
        RC_ASSERT((std::array<float, 3>{found[i].x_mm, found[i].y_mm, found[i].z_mm} == expected[i]));
    }
  }
}

// The bound that lets the rest of the volume be left out: planes 10 apart and slopes to 0.1 mean drifts to half a
// voxel.
RC_GTEST_PROP(CoarseMaxima, no_voxel_of_a_full_count_exceeds_the_box_round_it_on_the_nearest_plane, ()) {
  const Rays rays = rays_through(12, 40, 15, 12, *rc::gen::inRange(0U, 1U << 30));
  const auto fine = unit_grid(30, 24, 40, 1, -19.5F), coarse = unit_grid(30, 24, 4, 10, -15);
  RayCounter all(fine, rays.capacity(), 1), few(coarse, rays.capacity(), 1);
  all.count(rays, {}, 1);
  few.count(rays, {}, 1);
  for (int z = 0; z < fine.planes; ++z)
    for (int y = 1; y <= fine.size_y; ++y)
      for (int x = 1; x <= fine.size_x; ++x) RC_ASSERT(all.at(x, y, z) <= candidate_at(few, x, y, z / 10).rays);
}

}  // namespace
}  // namespace rptv
