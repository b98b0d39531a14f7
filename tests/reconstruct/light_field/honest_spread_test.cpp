// SPDX-License-Identifier: MIT
// What covariances need beyond noise: lenslets that disagree, two taken for one, several places that fit.
#include <gtest/gtest.h>

#include "reconstruct/light_field/lenslet_misfit.hpp"
#include "reconstruct/light_field/other_places.hpp"
#include "reconstruct/light_field/pair_spread.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

using testing::kRadiusMm;
using testing::small_camera;

constexpr double kLight = 3000, kNoiseGrey = 0.6, kGain = 5;
constexpr float kDarkVariance = 0.36F, kPerGrey = 0.2F;
constexpr std::size_t kMostPixels = 1 << 14;

ShakeOptions options() {
  const auto camera = small_camera();
  ShakeOptions options;
  options.model.pupil_radius_mm = 0.5 * camera.lens.exit_pupil_mm / camera.lens.image_f_number;
  options.model.particle_radius_mm = kRadiusMm;
  options.dark_noise_grey = kNoiseGrey, options.electrons_per_grey = kGain;
  options.lowest_z_mm = -25, options.highest_z_mm = 16;
  options.shallow_mm = 2 * camera.pitch_mm() * camera.lens.image_f_number;
  options.pitch_mm = camera.pitch_mm(), options.slope_rms = 0.25 / camera.lens.image_f_number;
  options.max_pixels = kMostPixels, options.max_particles = 64;
  return options;
}

// Grey values that the forward model makes, with noise of their own.
struct Modelled {
  explicit Modelled(unsigned seed) : random(seed) {}
  void add(const ImagePoint& at, double light) {
    EXPECT_TRUE(model.render(at, image));
    for (std::size_t i = 0; i < image.size; ++i) grey[image.pixel[i]] += static_cast<float>(light) * image.value[i];
  }
  void expose() {
    for (float& g : grey) {
      std::normal_distribution<float> noise(0, std::sqrt(kDarkVariance + g * kPerGrey));
      g += noise(random);
    }
  }
  std::mt19937 random;
  LightFieldCalibration camera = small_camera();
  LensletLattice lattice{camera};
  ImageModel model{camera, lattice, options().model};
  ParticleImage image{kMostPixels};
  std::vector<float> grey = std::vector<float>(512 * 384);
};

FittedParticle particle_at(const ImagePoint& at, double light) {
  FittedParticle p;
  p.at = at, p.light = light, p.chi_square = 1;
  return p;
}

double factor_of(Modelled& scene, const ImagePoint& at) {
  LensletMisfit misfit(scene.camera, scene.lattice);
  EXPECT_TRUE(scene.model.render(at, scene.image));
  std::vector<float> grey(scene.image.size), others(scene.image.size);
  for (std::size_t i = 0; i < scene.image.size; ++i) grey[i] = scene.grey[scene.image.pixel[i]];
  const Seen seen{grey.data(), others.data(), kDarkVariance, kPerGrey, 0};
  return misfit(scene.image, seen, kLight);
}

TEST(LensletMisfit, is_one_for_noise_and_large_where_a_neighbour_was_missed) {
  const ImagePoint at{0.1, -0.05, 9};
  double of_noise = 0;
  constexpr unsigned kScenes = 40;
  for (unsigned seed = 1; seed <= kScenes; ++seed) {
    Modelled scene(seed);
    scene.add(at, kLight);
    scene.expose();
    of_noise += factor_of(scene, at) / kScenes;
  }
  EXPECT_GE(of_noise, 1);
  EXPECT_LE(of_noise, 1.1);
  Modelled scene(1);
  scene.add(at, kLight), scene.add({0.2, -0.05, 6}, kLight);
  scene.expose();
  EXPECT_GE(factor_of(scene, at), 20);
}

TEST(PairSpread, reaches_from_the_middle_to_each_of_two_and_leaves_single_particles_alone) {
  Modelled scene(1);
  const ImagePoint at{0.1, -0.05, 9};
  scene.add(at, 2 * kLight);
  std::vector<FittedParticle> particles(9, particle_at({-0.3, 0.2, 4}, kLight));
  particles.push_back(particle_at(at, 2 * kLight));
  PairSpread spread(scene.camera, scene.lattice, options());
  spread.widen(particles, scene.grey);
  for (std::size_t k = 0; k < 9; ++k) EXPECT_EQ(particles[k].covariance.xx, 0);
  const double half_mm = std::sqrt(particles.back().covariance.xx);
  EXPECT_GE(half_mm, 0.004);
  EXPECT_LE(half_mm, 0.03);
  EXPECT_GE(std::sqrt(particles.back().covariance.zz), 0.2);
  particles.back().chi_square = 1.5;  // what is left unexplained lets them be farther apart
  particles.back().covariance = {};
  spread.widen(particles, scene.grey);
  EXPECT_GE(std::sqrt(particles.back().covariance.xx), half_mm);
}

TEST(PairSpread, takes_no_particle_for_two_where_lights_differ_as_much_anyway) {
  Modelled scene(1);
  std::vector<FittedParticle> particles;
  for (int k = -10; k <= 10; ++k) particles.push_back(particle_at({0.1, -0.05, 9}, kLight * std::exp(0.08 * k)));
  PairSpread(scene.camera, scene.lattice, options()).widen(particles, scene.grey);
  for (const auto& p : particles) EXPECT_EQ(p.covariance.xx, 0);
}

TEST(OtherPlaces, leads_out_of_most_wrong_maxima_near_the_array) {
  int found = 0;
  constexpr int kScenes = 12;
  for (unsigned seed = 1; seed <= kScenes; ++seed) {
    Modelled scene(seed);
    std::uniform_real_distribution<double> aside(-0.06, 0.06), depth(1.5, 4);
    const ImagePoint at{aside(scene.random), aside(scene.random), depth(scene.random)};
    scene.add(at, kLight);
    scene.expose();
    FittedParticle wrong = particle_at({at.x + 0.04, at.y - 0.02, at.z - 1}, kLight);
    std::vector<float> explained(scene.grey.size());
    EXPECT_TRUE(scene.model.render(wrong.at, scene.image));
    for (std::size_t i = 0; i < scene.image.size; ++i)
      explained[scene.image.pixel[i]] = static_cast<float>(kLight) * scene.image.value[i];
    OtherPlaces places(scene.camera, scene.lattice, options(), kMostPixels);
    EXPECT_GE(places.improve(wrong, {scene.grey, explained}), 0);
    found += std::hypot(wrong.at.x - at.x, wrong.at.y - at.y) < 0.02 && std::abs(wrong.at.z - at.z) < 0.6 ? 1 : 0;
  }
  EXPECT_GE(found, kScenes / 2);
}

}  // namespace
}  // namespace rptv
