// SPDX-License-Identifier: MIT
// Square and hexagonal lattices with distortion: there and back, nearest against brute force.
#include "calibration/light_field/lenslet_geometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rptv {
namespace {

LatticeParameters bent(const std::string& shape, double rotation_rad) {
  LatticeParameters p;
  p.shape = shape, p.pitch_mm = 0.125, p.rotation_rad = rotation_rad, p.offset_mm = {0.02, -0.03}, p.radius_mm = 5;
  p.distortion_x_mm = {0.001, 0.002, 0.003, 0, 0.001, -0.02, 0, -0.02, 0.001};
  p.distortion_y_mm = {0.002, -0.001, 0, 0.004, 0, 0, -0.02, 0.001, -0.02};
  return p;
}

TEST(LensletGeometry, there_and_back_is_where_one_started) {
  for (const char* shape : {"square", "hexagonal"}) {
    const LensletGeometry geometry(bent(shape, 0.3));
    for (const double u : {-30.0, 0.0, 12.5})
      for (const double v : {-20.0, 3.25, 25.0}) {
        const auto at = geometry.position_mm(u, v);
        const auto back = geometry.lattice_of(at[0], at[1]);
        EXPECT_NEAR(back[0], u, 1e-8);
        EXPECT_NEAR(back[1], v, 1e-8);
      }
  }
}

TEST(LensletGeometry, six_neighbours_of_a_hexagonal_lattice_are_a_pitch_away) {
  LatticeParameters p;
  p.shape = "hexagonal", p.pitch_mm = 0.1;
  const LensletGeometry geometry(p);
  for (const auto& [du, dv] : {std::pair{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}) {
    const auto at = geometry.position_mm(du, dv);
    EXPECT_NEAR(std::hypot(at[0], at[1]), 0.1, 1e-12);
    EXPECT_NEAR(geometry.distance2(du, dv), 1, 1e-12);
  }
}

TEST(LensletGeometry, the_nearest_lattice_point_is_the_nearest) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-2, 2);
  for (const char* shape : {"square", "hexagonal"})
    for (const double turn : {0.0, 0.2, -0.5}) {
      auto p = bent(shape, turn);
      p.distortion_x_mm.fill(0), p.distortion_y_mm.fill(0);
      const LensletGeometry geometry(p);
      for (int trial = 0; trial < 200; ++trial) {
        const double x = place(random), y = place(random);
        const auto [u, v] = geometry.nearest_of(x, y);
        const auto mine = geometry.position_mm(u, v);
        for (int du = -2; du <= 2; ++du)
          for (int dv = -2; dv <= 2; ++dv) {
            const auto other = geometry.position_mm(u + du, v + dv);
            ASSERT_LE(std::hypot(mine[0] - x, mine[1] - y), std::hypot(other[0] - x, other[1] - y) + 1e-12);
          }
      }
    }
}

TEST(LensletGeometry, reach_holds_every_neighbour_within_a_box) {
  for (const char* shape : {"square", "hexagonal"}) {
    auto p = bent(shape, 0.4);
    p.distortion_x_mm.fill(0), p.distortion_y_mm.fill(0);
    const LensletGeometry geometry(p);
    const auto [reach_u, reach_v] = geometry.reach(0.5);
    const auto middle = geometry.position_mm(0, 0);
    for (int u = -12; u <= 12; ++u)
      for (int v = -12; v <= 12; ++v) {
        const auto at = geometry.position_mm(u, v);
        if (std::abs(at[0] - middle[0]) > 0.5 || std::abs(at[1] - middle[1]) > 0.5) continue;
        EXPECT_LE(std::abs(u), reach_u);
        EXPECT_LE(std::abs(v), reach_v);
      }
  }
}

}  // namespace
}  // namespace rptv
