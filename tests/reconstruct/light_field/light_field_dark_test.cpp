// SPDX-License-Identifier: MIT
// Thresholds by the calibration's arrays, pixel by pixel, and what they are where it has none.
#include "reconstruct/light_field/light_field_dark.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

constexpr ImageShape kShape{60, 45, 2};

LightFieldCalibration camera() { return testing::small_camera(kShape.width_px, kShape.height_px); }

LightFieldSettings settings(double background, double threshold, double sigmas) {
  LightFieldSettings s;
  s.background = background, s.threshold = threshold, s.threshold_sigmas = sigmas, s.noise_grey = 0.5;
  return s;
}

/// Arrays for lenslets -4 … 4 and for every pixel; area 0.5 where the light is below 0.5: half of it is cut.
CalibrationArrays arrays() {
  CalibrationArrays a;
  a.ray = {-4, -4, 9, 9, std::vector<std::uint8_t>(81)};
  for (int k = 0; k < 81; ++k) {
    const float light = static_cast<float>(*rc::gen::inRange(0, 12)) / 10;
    a.vignetting.push_back(light), a.area.push_back(light < 0.5F ? 0.5F : 1.0F);
  }
  a.width_px = kShape.width_px, a.height_px = kShape.height_px;
  for (std::size_t i = 0; i < kShape.pixels(); ++i) {
    a.dark_level.push_back(static_cast<float>(*rc::gen::inRange(0, 50)));
    a.dark_noise.push_back(static_cast<float>(*rc::gen::inRange(0, 8)));
  }
  return a;
}

// By the definition, box by box and lenslet by lenslet.
double expected_limit(const LightFieldCalibration& c, const LensletLattice& lattice, const LightFieldSettings& s,
                      std::int64_t column, std::int64_t row) {
  const auto at = [](std::int64_t x, std::int64_t y) { return static_cast<std::size_t>(y * kShape.width_px + x); };
  double square = 0, count = 0;
  for (std::int64_t y = std::max<std::int64_t>(0, row - 8); y <= std::min<std::int64_t>(row + 8, kShape.height_px - 1);
       ++y)
    for (std::int64_t x = std::max<std::int64_t>(0, column - 8);
         x <= std::min<std::int64_t>(column + 8, kShape.width_px - 1); ++x) {
      square += std::pow(static_cast<double>(c.arrays.dark_noise[at(x, y)]), 2);
      ++count;
    }
  const double noise = std::max(static_cast<double>(c.arrays.dark_noise[at(column, row)]), std::sqrt(square / count));
  const auto axis = c.optical_axis_px();
  std::array<std::uint32_t, 1> lenslet{};
  lattice.lenslets_of((static_cast<double>(column) - axis[0]) * c.pixel_mm(),
                      (static_cast<double>(row) - axis[1]) * c.pixel_mm(), lenslet);
  const double bright = static_cast<double>(lattice.brightness(lenslet[0]));
  const double share = bright > 0 ? std::clamp(bright, 0.05, 1.0) : 1;
  return static_cast<double>(c.arrays.dark_level[at(column, row)]) +
         std::max(s.threshold * share, s.threshold_sigmas * noise);
}

RC_GTEST_PROP(LightFieldDark, lights_a_pixel_by_its_own_noise_and_its_lenslets_light, ()) {
  auto c = camera();
  c.arrays = arrays();
  const LensletLattice lattice(c);
  const auto s = settings(0, *rc::gen::inRange(0, 60), *rc::gen::inRange(1, 7));
  const LightFieldDark dark(s, c, lattice, kShape, {});
  for (std::uint32_t row = 0; row < kShape.height_px; ++row)
    for (std::uint32_t column = 0; column < kShape.width_px; ++column) {
      const double limit = expected_limit(c, lattice, s, column, row);
      const double found = dark.now().limit.limits()[row * kShape.width_px + column];
      RC_ASSERT(found <= limit + 1e-3);
      RC_ASSERT(found > limit - 1 - 1e-3);
    }
}

TEST(LightFieldDark, is_one_number_where_the_calibration_has_no_arrays) {
  const auto c = camera();
  const LightFieldDark dark(settings(20, 15, 6), c, LensletLattice(c), kShape, {});
  EXPECT_TRUE(dark.now().limit.uniform());
  EXPECT_EQ(dark.now().limit.limits()[7], 35);
  EXPECT_EQ(dark.threshold_of(7), 15);
}

TEST(LightFieldDark, believes_a_background_that_is_given_before_the_calibrations) {
  auto c = camera();
  c.arrays.width_px = kShape.width_px, c.arrays.height_px = kShape.height_px;
  c.arrays.dark_level.assign(kShape.pixels(), 30), c.arrays.dark_noise.assign(kShape.pixels(), 1);
  const LensletLattice lattice(c);
  const std::vector<std::uint16_t> grey(kShape.pixels(), 12);
  const ImageView image{reinterpret_cast<const std::byte*>(grey.data()), kShape};
  EXPECT_EQ(LightFieldDark(settings(0, 10, 6), c, lattice, kShape, {}).now().limit.limits()[0], 40);
  EXPECT_EQ(LightFieldDark(settings(20, 10, 6), c, lattice, kShape, {}).now().limit.limits()[0], 30);
  EXPECT_EQ(LightFieldDark(settings(20, 10, 6), c, lattice, kShape, image).now().limit.limits()[0], 22);
}

TEST(LightFieldDark, without_measured_noise_keeps_above_that_of_the_settings_but_never_above_the_threshold) {
  auto c = camera();
  c.arrays.ray = {-9, -9, 19, 19, std::vector<std::uint8_t>(361)};
  c.arrays.vignetting.assign(361, 0.1F);
  const LensletLattice lattice(c);
  EXPECT_EQ(LightFieldDark(settings(20, 10, 6), c, lattice, kShape, {}).now().limit.limits()[0], 23);
  EXPECT_EQ(LightFieldDark(settings(20, 10, 60), c, lattice, kShape, {}).now().limit.limits()[0], 30);
}

}  // namespace
}  // namespace rptv
