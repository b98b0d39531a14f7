// SPDX-License-Identifier: MIT
// Draws points and rays, and sorts the rays by lenslet.
#include "tests/bench/timing_case.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <tuple>

namespace rptv::bench {

TimingCase make_timing_case(std::int32_t size_x, std::int32_t size_y, std::int32_t planes, std::size_t rays,
                            std::size_t points, double slope) {
  TimingCase made;
  made.grid.size_x = size_x, made.grid.size_y = size_y, made.grid.planes = planes;
  made.grid.first_z_mm = static_cast<float>(1 - planes) / 2;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t i = 0; i < points; ++i)
    made.points.push_back({size_x * unit(random), size_y * unit(random), (unit(random) - 0.5) * planes});
  made.rays = Rays(rays, 1);
  for (std::size_t i = 0; i < rays; ++i) {
    const auto& [x, y, z] = made.points[i % points];
    const double slope_x = slope * (2 * unit(random) - 1), slope_y = slope * (2 * unit(random) - 1);
    made.rays.ray[i] = {static_cast<float>(std::floor(x - slope_x * z)),
                        static_cast<float>(std::floor(y - slope_y * z)), static_cast<float>(slope_x),
                        static_cast<float>(slope_y)};
  }
  std::sort(made.rays.ray.begin(), made.rays.ray.end(), [](const Ray& a, const Ray& b) {
    return std::tie(a.centre_y, a.centre_x) < std::tie(b.centre_y, b.centre_x);
  });
  for (std::size_t i = 0; i < rays; ++i) made.rays.pixel[i] = static_cast<std::uint32_t>(i);
  made.rays.size = made.rays.pixels = rays;
  return made;
}

}  // namespace rptv::bench
