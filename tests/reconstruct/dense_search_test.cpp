// SPDX-License-Identifier: MIT
// Particles so dense that their images overlap, over traced images: found whole, repeatable, without allocations.
#include "reconstruct/dense_search.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "reconstruct/light_field.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/small_scene.hpp"
#include "tests/reconstruct/traced_image.hpp"

namespace rptv {
namespace {

using testing::ImageParticle;
using testing::kRadiusMm;
using testing::small_camera;
using testing::TracedImage;

constexpr std::int64_t kWidth = 256, kHeight = 224;
constexpr double kGain = 5, kReadNoise = 0.6;
constexpr int kPhotons = 15000;

struct Scene {
  // Particles with all of their light on the sensor.
  Scene(int particles, unsigned seed) : camera(small_camera(kWidth, kHeight)), image(camera, seed) {
    truth = testing::scatter(particles, 0.6, 0.5, -14, 10, 0.03, seed);
    for (const auto& p : truth) image.add(p, kRadiusMm, kPhotons);
    grey = image.expose(kGain, kReadNoise);
  }
  ImageView view() const { return {reinterpret_cast<const std::byte*>(grey.data()), image.shape()}; }
  LightFieldCalibration camera;
  TracedImage image;
  std::vector<ImageParticle> truth;
  std::vector<std::uint16_t> grey;
};

LightFieldSettings settings(const std::string& search) {
  auto s = testing::small_settings();
  s.volume_z_mm = {-16, 12};
  s.background = TracedImage::kBlack, s.threshold = 5;
  s.noise_grey = kReadNoise, s.electrons_per_grey = kGain;
  s.refine = true, s.refine_search = search;
  return s;
}

struct Outcome {
  double found = 0, measured = 0;
};

Outcome outcome_of(const Scene& scene, const std::string& search) {
  LightField light_field(settings(search), scene.camera, {});
  Particles found(512);
  light_field.reconstruct(scene.view(), found);
  EXPECT_EQ(light_field.counts().refused_particles + light_field.counts().refused_candidates, 0U);
  Outcome outcome;
  for (const auto& p : scene.truth) outcome.found += testing::nearest(found, p) >= 0 ? 1 : 0;
  outcome.measured = static_cast<double>(found.size());
  return outcome;
}

TEST(DenseSearch, finds_nearly_all_particles_where_most_lit_pixels_are_those_of_several) {
  constexpr int kParticles = 45;  // 0.6 a lenslet of the lit box
  Outcome by_rays, whole;
  for (const unsigned seed : {1U, 2U}) {
    const Scene scene(kParticles, seed);
    const Outcome rays = outcome_of(scene, "rays"), grey = outcome_of(scene, "grey_values");
    by_rays.found += rays.found, by_rays.measured += rays.measured;
    whole.found += grey.found, whole.measured += grey.measured;
  }
  std::printf("%d particles twice: by rays %.0f of %.0f, by grey values %.0f of %.0f\n", kParticles, by_rays.found,
              by_rays.measured, whole.found, whole.measured);
  EXPECT_LT(by_rays.found, 0.75 * 2 * kParticles);
  EXPECT_GE(whole.found, 0.95 * 2 * kParticles);
  EXPECT_GE(whole.found, 0.95 * whole.measured);
}

}  // namespace
}  // namespace rptv
