// SPDX-License-Identifier: MIT
// The whole light-field stage over painted images with exact truth.
#include "reconstruct/light_field/light_field.hpp"

#include <gtest/gtest.h>

#include "calibration/light_field/object_map.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/core/same_particles.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

using testing::kRadiusMm;
using testing::nearest;
using testing::paint;
using testing::PaintedImage;
using testing::scene;
using testing::small_camera;
using testing::small_settings;

TEST(LightField, finds_painted_particles_and_no_others) {
  LightField light_field(small_settings(), small_camera(), {});
  std::size_t found_count = 0, ghosts = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto truth = scene(seed);
    ASSERT_EQ(truth.size(), 25U);
    const auto image = paint(truth);
    Particles found(512);
    light_field.reconstruct(image.view(), found);
    std::size_t hits = 0;
    for (const auto& p : truth) hits += nearest(found, p) >= 0;
    found_count += hits;
    ghosts += found.size() - hits;
    EXPECT_TRUE(std::is_sorted(found.support.rbegin(), found.support.rend()));
  }
  EXPECT_GE(found_count, 147U);  // of 150
  EXPECT_LE(ghosts, 3U);
}

TEST(LightField, states_covariances_that_fit_its_errors) {
  LightField light_field(small_settings(), small_camera(), {});
  double x2 = 0, z2 = 0, n = 0;
  std::vector<double> normalised;
  for (unsigned seed = 11; seed <= 22; ++seed) {
    const auto truth = testing::scatter(8, 1.5, 1.0, -20, 10, 0.9, seed);
    const auto image = paint(truth);
    Particles found(512);
    light_field.reconstruct(image.view(), found);
    for (const auto& p : truth) {
      const int i = nearest(found, p);
      if (i < 0) continue;
      const auto k = static_cast<std::size_t>(i);
      const auto& c = found.covariance_mm2[k];
      ASSERT_TRUE(c[0] > 0 && c[3] > 0 && c[5] > 0 && c[0] * c[3] > c[1] * c[1] && c[0] * c[5] > c[2] * c[2]);
      x2 += (found.x_mm[k] - p.x) * (found.x_mm[k] - p.x) / c[0];
      z2 += (found.z_mm[k] - p.z) * (found.z_mm[k] - p.z) / c[5];
      ++n;
    }
  }
  ASSERT_GE(n, 90);
  EXPECT_GT(x2 / n, 0.03);  // quantisation by the pitch scatters less than independent errors would, never much more
  EXPECT_LT(x2 / n, 2.0);
  EXPECT_GT(z2 / n, 0.03);
  EXPECT_LT(z2 / n, 4.0);
}

TEST(LightField, object_space_is_image_space_mapped) {
  const auto image = paint(scene(3));
  auto settings = small_settings();
  LightField in_image(settings, small_camera(), {});
  settings.space = "object";
  LightField in_object(settings, small_camera(), {});
  Particles a(512), b(512);
  in_image.reconstruct(image.view(), a);
  in_object.reconstruct(image.view(), b);
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 20U);
  const ObjectMap map(small_camera());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Point3 at{a.x_mm[i], a.y_mm[i], a.z_mm[i]};
    const Point3 expected = map.to_object(at);
    EXPECT_DOUBLE_EQ(b.x_mm[i], expected[0]);
    EXPECT_DOUBLE_EQ(b.z_mm[i], expected[2]);
    EXPECT_DOUBLE_EQ(b.covariance_mm2[i][5], map.to_object(a.covariance_mm2[i], map.jacobian(at))[5]);
  }
}

TEST(LightField, gives_bit_identical_particles_with_any_number_of_threads_and_at_any_time) {
  const auto image = paint(scene(4)), other = paint(scene(5));
  auto settings = small_settings();
  settings.threads = 1;
  LightField one(settings, small_camera(), {});
  settings.threads = 3;
  LightField three(settings, small_camera(), {});
  Particles a(512), b(512), c(512);
  one.reconstruct(image.view(), a);
  three.reconstruct(image.view(), b);
  testing::expect_same(a, b);
  three.reconstruct(other.view(), c);
  three.reconstruct(image.view(), c);
  testing::expect_same(a, c);
}

TEST(LightField, takes_a_background_away_and_8_bit_images) {
  const auto camera = small_camera();
  const auto truth = scene(6);
  auto image = paint(truth);
  Particles plain(512), bright(512), eight(512);
  LightField(small_settings(), camera, {}).reconstruct(image.view(), plain);
  PaintedImage background(camera);
  for (std::size_t i = 0; i < background.pixels().size(); ++i) {
    background.pixels()[i] = static_cast<std::uint16_t>(1000 + i % 700);
    image.pixels()[i] = static_cast<std::uint16_t>(image.pixels()[i] + background.pixels()[i]);
  }
  LightField(small_settings(), camera, background.view()).reconstruct(image.view(), bright);
  testing::expect_same(plain, bright);
  std::vector<std::uint8_t> bytes;
  auto dark_around = paint(truth);
  for (const auto pixel : dark_around.pixels()) bytes.push_back(static_cast<std::uint8_t>(pixel));
  LightField(small_settings(), camera, {})
      .reconstruct({reinterpret_cast<const std::byte*>(bytes.data()), {512, 384, 1}}, eight);
  testing::expect_same(plain, eight);
}

TEST(LightField, allocates_nothing_after_construction) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer has replaced malloc";
  const auto first = paint(scene(7)), second = paint(testing::scatter(60, 1.7, 1.2, -20, 10, 0.2, 8));
  for (const std::array<const char*, 2> choice :
       {std::array{"coarse_to_fine", "auto"}, std::array{"coarse", "local_maxima"}, std::array{"coarse", "dbscan"}}) {
    auto settings = small_settings();
    const char* classification = choice[1];
    settings.counting = choice[0], settings.classification = classification;
    LightField light_field(settings, small_camera(), {});
    Particles found(512);
    light_field.reconstruct(first.view(), found);
    AllocationCounter counter;
    light_field.reconstruct(second.view(), found);
    light_field.reconstruct(first.view(), found);
    counter.disarm();
    EXPECT_EQ(counter.allocations(), 0U) << classification;
    EXPECT_EQ(counter.releases(), 0U) << classification;
    EXPECT_GT(found.size(), 20U);
  }
}

TEST(LightField, resolves_overlapping_sub_images_by_hypotheses) {
  auto camera = small_camera();
  camera.lens.image_f_number = 24;  // 1.2 pitches wide
  const auto truth = testing::scatter(12, 1.5, 1.0, -14, 10, 0.6, 9);
  // Painted by every lenslet, not by the nearest only: shift the painter's lattice by one lenslet at a time.
  PaintedImage image(camera);
  const LensletLattice lattice(camera);
  const auto axis = camera.optical_axis_px();
  for (const auto& p : truth)
    for (std::uint32_t l = 0; l < lattice.size(); ++l) {
      const auto c = lattice.centre_mm(l);
      for (int j = -11; j <= 11; ++j)
        for (int i = -11; i <= 11; ++i) {
          const auto spot = lattice.spot_mm(l);
          const long column = std::lround(spot[0] / 9e-3 + axis[0]) + i,
                     row = std::lround(spot[1] / 9e-3 + axis[1]) + j;
          if (column < 0 || row < 0 || column >= 512 || row >= 384) continue;
          const double x = (static_cast<double>(column) - axis[0]) * 9e-3,
                       y = (static_cast<double>(row) - axis[1]) * 9e-3;
          const double sx = (c[0] - x) / 3.75, sy = (c[1] - y) / 3.75, d = camera.lens.exit_pupil_mm;
          if (std::hypot(p.x + sx * (d - p.z), p.y + sy * (d - p.z)) > 0.5 / 24 * d) continue;
          if (std::max(std::abs(c[0] + sx * p.z - p.x), std::abs(c[1] + sy * p.z - p.y)) > 0.0625 + kRadiusMm) continue;
          image.pixels()[static_cast<std::size_t>(row * 512 + column)] = 200;
        }
    }
  auto settings = small_settings();
  const auto hits = [&](std::int64_t hypotheses) {
    settings.max_hypotheses = hypotheses;
    Particles found(512);
    LightField(settings, camera, {}).reconstruct(image.view(), found);
    std::size_t count = 0;
    for (const auto& p : truth) count += nearest(found, p) >= 0;
    return std::pair{count, found.size()};
  };
  const auto [found, all] = hits(4);
  EXPECT_GE(found, 11U);
  EXPECT_LE(all - found, 1U);
}

}  // namespace
}  // namespace rptv
