// SPDX-License-Identifier: MIT
// Rays near a point: every instruction set against a trial of all rays, and of all lenslets against the chosen ones.
#include "reconstruct/light_field/near_rays.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <random>

#include "reconstruct/light_field/pixels_to_rays.hpp"
#include "tests/core/instruction_sets.hpp"
#include "tests/reconstruct/light_field/painted_image.hpp"

namespace rptv {
namespace {

// Lit pixels all over, some rows of lenslets with none, so that runs of every length are searched.
struct Scene {
  explicit Scene(unsigned seed)
      : calibration(testing::small_camera()),
        lattice(calibration),
        pixels_to_rays(calibration, lattice, 1),
        window(lattice, 1 / calibration.lens.exit_pupil_mm, pixels_to_rays.slope_half_range()),
        rays(60'000, lattice.size()) {
    std::mt19937 random(seed);
    std::bernoulli_distribution is_lit(0.2);
    std::vector<std::uint32_t> lit;
    const auto pixels = static_cast<std::uint32_t>(calibration.sensor.width_px * calibration.sensor.height_px);
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel)
      if (pixel / 2000 % 3 != 0 && is_lit(random)) lit.push_back(pixel);
    pixels_to_rays.convert(lit, rays);
    taken.resize(rays.size);
    for (auto& mark : taken) mark = random() % 3 == 0 ? 1 : 0;
  }
  LightFieldCalibration calibration;
  LensletLattice lattice;
  PixelsToRays pixels_to_rays;
  RayWindow window;
  Rays rays;
  std::vector<std::uint8_t> taken;
};

TEST(NearRays, are_those_that_a_trial_of_all_rays_finds_with_every_instruction_set) {
  Scene scene(1);
  const Rays& rays = scene.rays;
  ASSERT_GT(rays.size, 10'000U);
  const double turn = scene.calibration.lenslets.rotation_deg * std::numbers::pi / 180;
  const RayGate gate{std::cos(turn), std::sin(turn), 0.1, 0};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> x(-2.5, 2.5), z(-20, 10), reach(0.02, 0.4);
  for (int trial = 0; trial < 40; ++trial) {
    const ImagePoint at{x(random), x(random) * 0.7, z(random)};
    const double reach_mm = reach(random);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < rays.size; ++i) {
      const double distance = gate.distance(offset_of(rays.ray[i], at));
      ASSERT_GT(std::abs(distance - reach_mm), 1e-12) << "the trial would be a matter of rounding";
      if (distance <= reach_mm) expected.push_back(i);
    }
    for (const InstructionSet set : testing::sets_here()) {
      NearRays search(scene.window, rays.capacity(), set);
      const auto found = search.find(rays, gate, at, reach_mm);
      // single precision: a ray at the very edge may fall on either side
      std::vector<std::uint32_t> differ;
      std::set_symmetric_difference(found.begin(), found.end(), expected.begin(), expected.end(),
                                    std::back_inserter(differ));
      for (const std::uint32_t i : differ)
        ASSERT_NEAR(gate.distance(offset_of(rays.ray[i], at)), reach_mm, 2e-6) << name_of(set);
      for (std::size_t k = 0; k < found.size(); ++k)
        ASSERT_NEAR(static_cast<double>(search.distances_mm()[k]), gate.distance(offset_of(rays.ray[found[k]], at)),
                    2e-6);
    }
  }
}

TEST(NearRays, are_the_same_bits_with_every_instruction_set) {
  Scene scene(3);
  const Rays& rays = scene.rays;
  const RayGate gate{0.9999, 0.0141, 0.1, 0};
  for (const ImagePoint at : {ImagePoint{0, 0, -6}, ImagePoint{1.2, -0.4, 8}, ImagePoint{-1.9, 0.9, 0.3}}) {
    NearRays plain(scene.window, rays.capacity(), InstructionSet::portable);
    const auto numbers = plain.find(rays, gate, at, 0.15);
    RayColumns free(rays.capacity()), kept(rays.capacity());
    plain.gather(rays, scene.taken, gate, at, 0.15, free);
    std::vector<std::uint32_t> untaken;
    for (const auto i : numbers)
      if (scene.taken[i] == 0) untaken.push_back(i);
    ASSERT_EQ(free.size, untaken.size());
    ASSERT_GT(free.size, 20U);
    for (std::size_t k = 0; k < free.size; ++k) ASSERT_EQ(free.slope_x[k], rays.ray[untaken[k]].slope_x);
    const ImagePoint aside{at.x + 0.05, at.y, at.z};
    plain.gather(rays, scene.taken, gate, at, 0.15, kept);
    plain.keep(gate, aside, 0.11, kept);
    ASSERT_LT(kept.size, free.size);
    for (const InstructionSet set : testing::sets_here()) {
      NearRays search(scene.window, rays.capacity(), set);
      const auto found = search.find(rays, gate, at, 0.15);
      ASSERT_TRUE(std::equal(found.begin(), found.end(), numbers.begin(), numbers.end())) << name_of(set);
      for (std::size_t k = 0; k < found.size(); ++k) ASSERT_EQ(search.distances_mm()[k], plain.distances_mm()[k]);
      RayColumns columns(rays.capacity());
      search.gather(rays, scene.taken, gate, at, 0.15, columns);
      ASSERT_EQ(columns.size, free.size) << name_of(set);
      search.keep(gate, aside, 0.11, columns);
      ASSERT_EQ(columns.size, kept.size) << name_of(set);
      for (std::size_t k = 0; k < kept.size; ++k) {
        ASSERT_EQ(columns.centre_x[k], kept.centre_x[k]);
        ASSERT_EQ(columns.centre_y[k], kept.centre_y[k]);
        ASSERT_EQ(columns.slope_x[k], kept.slope_x[k]);
        ASSERT_EQ(columns.slope_y[k], kept.slope_y[k]);
      }
    }
  }
}

TEST(Rays, of_one_pixel_are_a_ring) {
  auto calibration = testing::small_camera();
  calibration.lens.image_f_number = 16;  // sub-images are twice as wide as the pitch
  const LensletLattice lattice(calibration);
  const PixelsToRays pixels_to_rays(calibration, lattice, 3);
  std::vector<std::uint32_t> lit;
  for (std::uint32_t pixel = 100; pixel < 60'000; pixel += 37) lit.push_back(pixel);
  Rays rays(4 * lit.size(), lattice.size());
  pixels_to_rays.convert(lit, rays);
  std::vector<std::uint32_t> rays_of_pixel(lit.size());
  for (std::size_t i = 0; i < rays.size; ++i) ++rays_of_pixel[rays.pixel[i]];
  std::uint32_t most = 0;
  for (std::uint32_t i = 0; i < rays.size; ++i) {
    std::uint32_t length = 1;
    for (std::uint32_t same = rays.same_pixel[i]; same != i && length < 9; same = rays.same_pixel[same]) {
      ASSERT_EQ(rays.pixel[same], rays.pixel[i]);
      ++length;
    }
    ASSERT_EQ(length, rays_of_pixel[rays.pixel[i]]);
    most = std::max(most, length);
  }
  EXPECT_GT(most, 1U);
}

}  // namespace
}  // namespace rptv
