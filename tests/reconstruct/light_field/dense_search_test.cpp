// SPDX-License-Identifier: MIT
// Particles so dense that their images overlap, over traced images: found whole, repeatable, without allocations.
#include "reconstruct/light_field/dense_search.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "tests/core/allocation_counter.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"
#include "tests/reconstruct/light_field/traced_image.hpp"

namespace rptv {
namespace {

using testing::ImageParticle;
using testing::kRadiusMm;
using testing::small_camera;
using testing::TracedImage;

constexpr double kGain = 5, kReadNoise = 0.6;
constexpr int kPhotons = 15000;

struct Scene {
  // Particles with all of their light on the sensor; every third has half as much.
  Scene(int particles, unsigned seed) : camera(small_camera(256, 224)), image(camera, seed) {
    truth = testing::scatter(particles, 0.6, 0.5, -14, 10, 0.03, seed);
    for (std::size_t i = 0; i < truth.size(); ++i) image.add(truth[i], kRadiusMm, i % 3 == 0 ? kPhotons / 2 : kPhotons);
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
  Outcome outcome{0, static_cast<double>(found.size())};
  for (const auto& p : scene.truth) outcome.found += testing::nearest(found, p) >= 0 ? 1 : 0;
  return outcome;
}

TEST(DenseSearch, finds_nearly_all_particles_where_most_lit_pixels_are_those_of_several) {
  constexpr int kParticles = 45;  // more than one in two lenslets of the lit box
  const Scene scene(kParticles, 1);
  const Outcome rays = outcome_of(scene, "rays"), whole = outcome_of(scene, "grey_values");
  EXPECT_LT(rays.found, 0.75 * kParticles);
  EXPECT_GE(whole.found, 0.95 * kParticles);
  EXPECT_GE(whole.found, 0.95 * whole.measured);
}

TEST(DenseSearch, finds_nothing_in_an_image_of_noise) {
  const Scene scene(0, 1);
  EXPECT_EQ(outcome_of(scene, "grey_values").measured, 0);
}

TEST(DenseSearch, gives_the_same_bits_with_any_number_of_threads_and_after_other_frames) {
  const Scene scene(8, 2), other(8, 3);
  std::vector<std::vector<double>> results;
  for (const std::int64_t threads : {1, 3}) {
    auto s = settings("grey_values");
    s.threads = threads;
    LightField light_field(s, scene.camera, {});
    Particles found(512);
    if (threads > 1) light_field.reconstruct(other.view(), found);
    light_field.reconstruct(scene.view(), found);
    results.emplace_back();
    for (std::size_t i = 0; i < found.size(); ++i)
      results.back().insert(results.back().end(), {found.x_mm[i], found.y_mm[i], found.z_mm[i], found.residual_mm[i]});
  }
  EXPECT_EQ(results[0].size(), 32U);
  EXPECT_EQ(results[0], results[1]);
}

TEST(DenseSearch, allocates_nothing_once_it_is_built) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "the sanitizer has replaced malloc";
  const Scene scene(10, 4);
  LightField light_field(settings("grey_values"), scene.camera, {});
  Particles found(512);
  AllocationCounter counter;
  light_field.reconstruct(scene.view(), found);
  counter.disarm();
  EXPECT_EQ(counter.allocations(), 0U);
  EXPECT_EQ(found.size(), 10U);
}

TEST(DenseSearch, counts_particles_for_which_there_is_no_room) {
  const Scene scene(8, 2);
  auto s = settings("grey_values");
  s.max_particles = 3;
  LightField light_field(s, scene.camera, {});
  Particles found(512);
  light_field.reconstruct(scene.view(), found);
  EXPECT_LE(found.size(), 3U);
  EXPECT_GE(light_field.counts().refused_particles, 5U);
}

TEST(DenseSearch, refuses_what_it_cannot_do) {
  using ::testing::HasSubstr;
  const auto refusal_of = [](const LightFieldSettings& s, const LightFieldCalibration& camera) -> std::string {
    try {
      const LightField light_field(s, camera, {});
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::configuration);
      return error.what();
    }
    return "taken";
  };
  auto without_fit = settings("grey_values");
  without_fit.refine = false;
  EXPECT_THAT(refusal_of(without_fit, small_camera()), HasSubstr("refine = true"));
}

TEST(Footprints, refuse_a_lens_so_wide_open_that_a_particle_lights_more_pixels_than_they_hold) {
  auto camera = small_camera(1024, 768);
  camera.lens.image_f_number = 2;
  const LensletLattice lattice(camera);
  ImageModelOptions model;
  model.pupil_radius_mm = 0.5 * camera.lens.exit_pupil_mm / camera.lens.image_f_number;
  model.particle_radius_mm = kRadiusMm;
  EXPECT_THROW(Footprints(camera, lattice, model, {-16, 12, 4, 6}), Error);
}

// The light that a particle gives to the residual, and some more, is all of its light.
TEST(ResidualSearch, is_not_misled_by_light_of_others_but_by_missing_light) {
  const auto camera = small_camera(256, 224);
  const LensletLattice lattice(camera);
  ImageModelOptions model;
  model.pupil_radius_mm = 0.5 * camera.lens.exit_pupil_mm / camera.lens.image_f_number;
  model.particle_radius_mm = kRadiusMm;
  Footprints footprints(camera, lattice, model, {4, 8, 2, 6});
  constexpr double kLight = 3000;
  footprints.set_light(kLight, 0.5, 1 / kGain);
  ResidualSearch search(footprints, lattice, {256, 224, 2}, 1 << 16, 2);
  const std::uint32_t middle = lattice.columns() * (lattice.rows() / 2) + lattice.columns() / 2;
  const ResidualHit there{0, 20, middle};
  std::vector<float> residual(256 * 224);
  EXPECT_NEAR(search.score(residual, there), -1, 1e-3);
  ImageModel images(camera, lattice, model);
  ParticleImage image(1 << 16);
  ASSERT_TRUE(images.render(footprints.at(there.footprint, middle), image));
  for (std::size_t i = 0; i < image.size; ++i) residual[image.pixel[i]] = static_cast<float>(kLight) * image.value[i];
  EXPECT_NEAR(search.score(residual, there), 1, 1e-3);
  const auto hits = search.find(residual, 0.9F, 1);
  ASSERT_FALSE(hits.empty());
  EXPECT_EQ(hits[0].lenslet, middle);
  EXPECT_EQ(hits[0].footprint, there.footprint);
  for (float& grey : residual) grey *= 3;
  EXPECT_NEAR(search.score(residual, there), 1, 1e-3);
  for (float& grey : residual) grey /= 6;
  EXPECT_NEAR(search.score(residual, there), 0, 1e-3);
  search.subtract(residual, there);
  EXPECT_NEAR(search.score(residual, there), -2, 1e-3);
}

}  // namespace
}  // namespace rptv
