// SPDX-License-Identifier: MIT
// Shaking over traced images: positions, honest covariances, ghosts, neighbours, repeatability.
#include "reconstruct/light_field/shake.hpp"

#include <gtest/gtest.h>

#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"
#include "tests/reconstruct/light_field/traced_image.hpp"

namespace rptv {
namespace {

using testing::ImageParticle;
using testing::kRadiusMm;
using testing::small_camera;
using testing::TracedImage;

constexpr double kFirstZeroUm = 15.96, kGain = 5, kReadNoise = 0.6;
constexpr int kPhotons = 15000;

ShakeOptions options() {
  const auto camera = small_camera();
  ShakeOptions options;
  options.model.pupil_radius_mm = 0.5 * camera.lens.exit_pupil_mm / camera.lens.image_f_number;
  options.model.particle_radius_mm = kRadiusMm;
  options.model.diffraction_zero_um = kFirstZeroUm;
  options.dark_noise_grey = kReadNoise, options.electrons_per_grey = kGain;
  options.lowest_z_mm = -25, options.highest_z_mm = 16;
  options.shallow_mm = 2 * camera.pitch_mm() * camera.lens.image_f_number;
  options.satellite_mm = camera.pitch_mm() / 4;
  options.pitch_mm = camera.pitch_mm(), options.slope_rms = 0.25 / camera.lens.image_f_number;
  options.subimage_px = camera.lenslets.focal_length_mm / camera.lens.image_f_number / camera.pixel_mm();
  return options;
}

struct Scene {
  explicit Scene(const std::vector<ImageParticle>& particles, unsigned seed) : image(small_camera(), seed) {
    for (const auto& p : particles) image.add(p, kRadiusMm, kPhotons, kFirstZeroUm);
    grey = image.expose(kGain, kReadNoise);
  }
  ImageView view() const { return {reinterpret_cast<const std::byte*>(grey.data()), image.shape()}; }
  TracedImage image;
  std::vector<std::uint16_t> grey;
  std::vector<float> background = std::vector<float>(512 * 384, static_cast<float>(TracedImage::kBlack));
};

std::vector<FittedParticle> starts(const std::vector<ImageParticle>& truth, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> aside(0, 0.02), depth(0, 0.5);
  std::vector<FittedParticle> all;
  for (const auto& p : truth) {
    FittedParticle start;
    start.at = {p.x + aside(random), p.y + aside(random), p.z + depth(random)};
    all.push_back(start);
  }
  return all;
}

struct Shaken {
  explicit Shaken(const ShakeOptions& o) : lattice(small_camera()), shake(small_camera(), lattice, o) {}
  LensletLattice lattice;
  Shake shake;
};

TEST(Shake, places_particles_far_better_than_the_pitch_with_honest_covariances) {
  Shaken s(options());
  double aside = 0, depth = 0, normalised_x = 0, normalised_z = 0, n = 0, light = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const auto truth = testing::scatter(12, 1.5, 1.0, -20, 12, 0.5, seed);
    const Scene scene(truth, seed);
    auto particles = starts(truth, seed);
    s.shake.begin(scene.view(), scene.background);
    ASSERT_EQ(s.shake.refine(particles, 0), truth.size());
    for (std::size_t i = 0; i < truth.size(); ++i) {
      const auto& p = particles[i];
      aside += std::pow(p.at.x - truth[i].x, 2) + std::pow(p.at.y - truth[i].y, 2);
      depth += std::pow(p.at.z - truth[i].z, 2);
      normalised_x += std::pow(p.at.x - truth[i].x, 2) / p.covariance.xx;
      normalised_z += std::pow(p.at.z - truth[i].z, 2) / p.covariance.zz;
      light += p.light;
      ++n;
    }
  }
  EXPECT_LT(std::sqrt(aside / n), 0.008);  // mm, of a pitch of 0.125
  EXPECT_LT(std::sqrt(depth / n), 0.30);
  EXPECT_NEAR(std::sqrt(normalised_x / n), 1, 0.5);
  EXPECT_NEAR(std::sqrt(normalised_z / n), 1, 0.5);
  EXPECT_NEAR(light / n, kPhotons / kGain, 0.05 * kPhotons / kGain);
}

TEST(Shake, parts_particles_whose_images_overlap) {
  const std::vector<ImageParticle> truth{{0.10, 0.05, 8}, {0.19, 0.02, 6}, {0.02, 0.12, -9}, {-1.2, 0.6, 3}};
  const Scene scene(truth, 3);
  auto particles = starts(truth, 3);
  Shaken s(options());
  s.shake.begin(scene.view(), scene.background);
  ASSERT_EQ(s.shake.refine(particles, 0), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(particles[i].at.x, truth[i].x, 0.02) << i;
    EXPECT_NEAR(particles[i].at.z, truth[i].z, 0.8) << i;
  }
}

TEST(Shake, drops_ghosts_and_twins_and_what_is_outside) {
  const std::vector<ImageParticle> truth{{0.1, 0.1, 8}, {-0.8, 0.4, -6}, {0.9, -0.5, 4}};
  const Scene scene(truth, 4);
  auto particles = starts(truth, 4);
  FittedParticle ghost, twin = particles[0], outside = particles[1];
  ghost.at = {-0.3, -0.6, 5};
  outside.at = {40, 0, 0};
  for (const auto& extra : {ghost, twin, outside}) particles.push_back(extra);
  Shaken s(options());
  s.shake.begin(scene.view(), scene.background);
  EXPECT_EQ(s.shake.refine(particles, 0), truth.size());
}

TEST(Shake, joins_the_halves_of_a_particle_that_two_lenslets_see) {
  const LensletLattice lattice(small_camera());
  const auto left = lattice.centre_mm(lattice.columns() * (lattice.rows() / 2) + lattice.columns() / 2);
  const ImageParticle truth{static_cast<double>(left[0]) + 0.0625, static_cast<double>(left[1]), -1.5};
  const Scene scene({truth, {1.3, 0.8, 5}, {-1.2, -0.7, -8}}, 5);
  auto particles =
      starts({{truth.x - 0.06, truth.y, 0}, {truth.x + 0.06, truth.y, 0}, {1.3, 0.8, 5}, {-1.2, -0.7, -8}}, 5);
  Shaken s(options());
  s.shake.begin(scene.view(), scene.background);
  ASSERT_EQ(s.shake.refine(particles, 0), 3U);
  EXPECT_NEAR(particles[0].at.x, truth.x, 0.01);
  EXPECT_NEAR(particles[0].at.z, truth.z, 0.5);
}

TEST(Shake, leaves_nothing_unexplained_but_what_nobody_was_told_of) {
  const std::vector<ImageParticle> truth{{0.1, 0.1, 8}, {-0.8, 0.4, -6}, {0.9, -0.5, 4}};
  const Scene scene(truth, 6);
  auto particles = starts({truth[0], truth[1]}, 6);
  Shaken s(options());
  s.shake.begin(scene.view(), scene.background);
  ASSERT_EQ(s.shake.refine(particles, 0), 2U);
  double left = 0, all = 0;
  for (std::uint32_t pixel = 0; pixel < 512 * 384; ++pixel) {
    left += static_cast<double>(s.shake.unexplained(pixel));
    all += static_cast<double>(scene.grey[pixel]) - TracedImage::kBlack;
  }
  EXPECT_NEAR(left / all, 1.0 / 3, 0.1);  // the faint tails of diffraction are left too
}

TEST(Shake, gives_the_same_bits_with_any_number_of_threads_and_after_other_frames) {
  const auto truth = testing::scatter(20, 1.6, 1.1, -20, 12, 0.3, 7);
  const Scene scene(truth, 7), other(testing::scatter(20, 1.6, 1.1, -20, 12, 0.3, 8), 8);
  const auto result = [&](std::size_t threads, bool warm) {
    auto o = options();
    o.threads = threads;
    Shaken s(o);
    if (warm) {
      auto before = starts(truth, 9);
      s.shake.begin(other.view(), other.background);
      s.shake.refine(before, 0);
    }
    auto particles = starts(truth, 7);
    s.shake.begin(scene.view(), scene.background);
    particles.resize(s.shake.refine(particles, 0));
    std::vector<double> numbers;
    for (const auto& p : particles) numbers.insert(numbers.end(), {p.at.x, p.at.y, p.at.z, p.light, p.covariance.zz});
    return numbers;
  };
  const auto one = result(1, false);
  EXPECT_GT(one.size(), 80U);
  EXPECT_EQ(one, result(3, false));
  EXPECT_EQ(one, result(2, true));
}

TEST(Shake, allocates_nothing_once_it_is_built) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer has replaced malloc";
  const auto truth = testing::scatter(20, 1.6, 1.1, -20, 12, 0.3, 7);
  const Scene scene(truth, 7);
  auto particles = starts(truth, 7), again = particles;
  Shaken s(options());
  s.shake.begin(scene.view(), scene.background);
  s.shake.refine(particles, 0);
  AllocationCounter counter;
  s.shake.begin(scene.view(), scene.background);
  s.shake.refine(again, 0);
  counter.disarm();
  EXPECT_EQ(counter.allocations(), 0U);
}

}  // namespace
}  // namespace rptv
