// SPDX-License-Identifier: MIT
// The two lattices against brute force and against the ray-traced set's own figures.
#include "calibration/light_field/lenslet_lattice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "core/error.hpp"

namespace rptv {
namespace {

LightFieldCalibration small_camera(double rotation_deg, double exit_pupil_mm, double f_number) {
  LightFieldCalibration c;
  c.sensor = {200, 150, 9.0, {}};
  c.lenslets.pitch_um = 125, c.lenslets.focal_length_mm = 3.75;
  c.lenslets.rotation_deg = rotation_deg, c.lenslets.offset_um = {-22.2, 28.7};
  c.lens.model = "telecentric", c.lens.magnification = 1;
  c.lens.exit_pupil_mm = exit_pupil_mm, c.lens.image_f_number = f_number;
  return c;
}

struct Near {
  double distance;
  std::uint32_t index;
};

std::vector<Near> by_distance(const LensletLattice& lattice, double x, double y) {
  std::vector<Near> all;
  for (std::uint32_t i = 0; i < lattice.size(); ++i) {
    const auto spot = lattice.spot_mm(i);
    all.push_back({std::hypot(spot[0] - x, spot[1] - y), i});
  }
  std::sort(all.begin(), all.end(), [](const Near& a, const Near& b) { return a.distance < b.distance; });
  return all;
}

TEST(LensletLattice, gives_every_pixel_the_lenslet_with_the_nearest_spot) {
  for (const double rotation : {0.0, 0.19, -7.0, 45.0})
    for (const double pupil : {0.0, 84.8, 20.0}) {
      const auto camera = small_camera(rotation, pupil, 0);
      const LensletLattice lattice(camera);
      for (int row = 0; row < 150; row += 7)
        for (int column = 0; column < 200; column += 3) {
          const double x = (column - 99.5) * 9e-3, y = (row - 74.5) * 9e-3;
          std::array<std::uint32_t, 1> found{};
          lattice.lenslets_of(x, y, found);
          ASSERT_NE(found[0], LensletLattice::kNone);
          const auto spot = lattice.spot_mm(found[0]);
          ASSERT_NEAR(std::hypot(spot[0] - x, spot[1] - y), by_distance(lattice, x, y)[0].distance, 1e-12);
        }
    }
}

TEST(LensletLattice, spots_lie_farther_from_the_axis_than_centres_by_the_exit_pupil) {
  const LensletLattice lattice(small_camera(0.19, 75.0, 0));
  for (std::uint32_t i = 0; i < lattice.size(); ++i) {
    const auto centre = lattice.centre_mm(i);
    const auto spot = lattice.spot_mm(i);
    ASSERT_NEAR(spot[0], static_cast<double>(centre[0]) * (1 + 3.75 / 75), 1e-6);
    ASSERT_NEAR(spot[1], static_cast<double>(centre[1]) * (1 + 3.75 / 75), 1e-6);
  }
}

TEST(LensletLattice, centres_follow_offset_pitch_and_rotation) {
  const auto camera = small_camera(10, 0, 0);
  const LensletLattice lattice(camera);
  const double turn = 10 * 3.14159265358979323846 / 180;
  double nearest = 1e9;
  for (std::uint32_t i = 0; i < lattice.size(); ++i) {  // lenslet (2, -1) is among them
    const auto c = lattice.centre_mm(i);
    nearest = std::min(nearest, std::hypot(c[0] - (-0.0222 + 0.125 * (std::cos(turn) * 2 + std::sin(turn))),
                                           c[1] - (0.0287 + 0.125 * (std::sin(turn) * 2 - std::cos(turn)))));
  }
  EXPECT_LT(nearest, 1e-6);
  const auto coordinates = lattice.on_true_lattice(lattice.centre_mm(7)[0], lattice.centre_mm(7)[1]);
  EXPECT_NEAR(coordinates[0], 7, 1e-5);
  EXPECT_NEAR(coordinates[1], 0, 1e-5);
}

TEST(LensletLattice, lists_all_lenslets_whose_overlapping_sub_images_cover_a_pixel) {
  const auto camera = small_camera(3, 90, 14);
  const LensletLattice lattice(camera);
  const double radius = 0.5 * 3.75 / 14 + std::sqrt(0.5) * 9e-3;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x_of(-0.9, 0.9), y_of(-0.67, 0.67);
  for (int trial = 0; trial < 300; ++trial) {
    const double x = x_of(random), y = y_of(random);
    std::array<std::uint32_t, 9> found{};
    lattice.lenslets_of(x, y, found);
    const auto expected = by_distance(lattice, x, y);
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (expected[k].distance > radius) {
        ASSERT_EQ(found[k], LensletLattice::kNone);
      } else {
        ASSERT_NE(found[k], LensletLattice::kNone);
        const auto spot = lattice.spot_mm(found[k]);
        ASSERT_NEAR(std::hypot(spot[0] - x, spot[1] - y), expected[k].distance, 1e-9);
      }
    }
  }
}

TEST(LensletLattice, a_hexagonal_distorted_array_gives_every_pixel_the_nearest_spot) {
  auto camera = small_camera(12, 50, 0);
  camera.lenslets.shape = "hexagonal";
  camera.lenslets.distortion_x_um = {0, 0, 2, 0, 0, -15, 0, -15, 0};
  const LensletLattice lattice(camera);
  for (int row = 0; row < 150; row += 7)
    for (int column = 0; column < 200; column += 3) {
      const double x = (column - 99.5) * 9e-3, y = (row - 74.5) * 9e-3;
      std::array<std::uint32_t, 1> found{};
      lattice.lenslets_of(x, y, found);
      ASSERT_NE(found[0], LensletLattice::kNone);
      const auto spot = lattice.spot_mm(found[0]);
      // The border between two cells is straight on the undistorted lattice: a hundredth of a pitch at most.
      ASSERT_NEAR(std::hypot(spot[0] - x, spot[1] - y), by_distance(lattice, x, y)[0].distance, 1.3e-3);
    }
}

TEST(LensletLattice, a_masked_lenslet_gets_no_pixel_neither_alone_nor_among_others) {
  auto camera = small_camera(3, 90, 14);
  camera.arrays.ray = {-1, -1, 3, 3, {0, 0, 0, 0, 8, 0, 0, 0, 0}};  // lenslet (0, 0)
  const LensletLattice masked(camera);
  camera.arrays.ray = {};
  const LensletLattice all(camera);
  std::size_t lost = 0;
  for (int row = 0; row < 150; ++row)
    for (int column = 0; column < 200; ++column) {
      const double x = (column - 99.5) * 9e-3, y = (row - 74.5) * 9e-3;
      std::array<std::uint32_t, 9> with{}, without{};
      all.lenslets_of(x, y, without), masked.lenslets_of(x, y, with);
      std::vector<std::uint32_t> expected;
      for (const auto lenslet : without)
        if (lenslet != LensletLattice::kNone && masked.masked(lenslet) == 0) expected.push_back(lenslet);
      lost += expected.size() < 9 && without[expected.size()] != LensletLattice::kNone ? 1 : 0;
      for (std::size_t k = 0; k < expected.size(); ++k) ASSERT_EQ(with[k], expected[k]);
      const auto end = expected.size() < with.size() ? with[expected.size()] : LensletLattice::kNone;
      ASSERT_EQ(end, LensletLattice::kNone);
    }
  EXPECT_GT(lost, 500U);  // a sub-image of 0.27 mm
}

TEST(LensletLattice, refuses_a_lattice_beyond_memory) {
  auto camera = small_camera(0, 0, 0);
  camera.sensor = {65536, 65536, 1000, {}};
  camera.lenslets.pitch_um = 0.1;
  EXPECT_THROW(LensletLattice{camera}, Error);
}

}  // namespace
}  // namespace rptv
