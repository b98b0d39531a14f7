// SPDX-License-Identifier: MIT
// Shaking against truth: places and light on painted images, what is left of them, and what is let go.
#include "reconstruct/multi_view/shaken_particles.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "calibration/space_algebra.hpp"
#include "tests/reconstruct/multi_view/painted_views.hpp"

namespace rptv {
namespace {

constexpr float kGrey = 4000;

Point3 moved(const Point3& place, double by_mm, std::mt19937& random) {
  std::normal_distribution<double> error(0, by_mm);
  return {place[0] + error(random), place[1] + error(random), place[2] + error(random)};
}

double worst_mm(const ShakenParticles& particles, const std::vector<Point3>& truth) {
  double worst = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) worst = std::max(worst, norm(particles.all()[i].at_mm - truth[i]));
  return worst;
}

/// Variance of the residual over that of the noise.
double left_over(const ShakenParticles& particles) {
  double sum = 0;
  for (const ResidualView& view : particles.views())
    for (int y = 0; y < view.height_px(); ++y)
      for (int x = 0; x < view.width_px(); ++x)
        sum += static_cast<double>(view.weight_row(y)[x] * view.residual_row(y)[x] * view.residual_row(y)[x]);
  return sum / (4.0 * 160 * 128);
}

RC_GTEST_PROP(ShakenParticles, go_where_the_images_say_they_are, ()) {
  const auto seed = *rc::gen::inRange(0U, 1000000U);
  const auto truth = testing::random_places(*rc::gen::inRange<std::size_t>(1, 60), seed);
  ShakenParticles particles = testing::painted_particles(truth, kGrey, 0);
  std::mt19937 random(seed);
  for (const Point3& place : truth) particles.push(moved(place, 0.012, random), kGrey * 0.8F);  // 0.2 px
  particles.subtract();
  for (int i = 0; i < 30; ++i) particles.sweep();
  RC_ASSERT(particles.all().size() == truth.size());
  RC_ASSERT(worst_mm(particles, truth) < 5e-4);  // 0.01 px; pixels are rounded
  for (const ShakenParticle& particle : particles.all()) {
    RC_ASSERT(std::abs(particle.grey / kGrey - 1) < 0.02F);
    RC_ASSERT(particle.views == 4U);
  }
}

TEST(ShakenParticles, leave_nothing_but_noise) {
  const auto truth = testing::random_places(400, 3);  // 0.02 particles per pixel
  ShakenParticles particles = testing::painted_particles(truth, kGrey, 20);
  std::mt19937 random(5);
  for (const Point3& place : truth) particles.push(moved(place, 0.012, random), kGrey);
  particles.subtract();
  EXPECT_GT(left_over(particles), 5);
  for (int i = 0; i < 12; ++i) particles.sweep();
  EXPECT_NEAR(left_over(particles), 1, 0.1);
}

TEST(ShakenParticles, have_errors_as_their_covariances_say) {
  constexpr unsigned kScenes = 40;
  constexpr std::size_t kPlaces = 10;  // hardly any overlap
  std::array<double, 3> square{};
  for (unsigned seed = 0; seed < kScenes; ++seed) {
    const auto truth = testing::random_places(kPlaces, seed);
    ShakenParticles particles = testing::painted_particles(truth, kGrey, 20);
    for (const Point3& place : truth) particles.push(place, kGrey);
    particles.subtract();
    for (int i = 0; i < 6; ++i) particles.sweep();
    for (std::size_t i = 0; i < kPlaces; ++i) {
      const ShakenParticle& particle = particles.all()[i];
      const std::array<double, 3> variance{particle.covariance_mm2[0], particle.covariance_mm2[3],
                                           particle.covariance_mm2[5]};
      for (std::size_t k = 0; k < 3; ++k)
        square[k] += std::pow(particle.at_mm[k] - truth[i][k], 2) / variance[k] / (kScenes * kPlaces);
    }
  }
  for (const double normalised : square) EXPECT_NEAR(normalised, 1, 0.25);
}

TEST(ShakenParticles, learn_how_wide_and_bright_particle_images_are) {
  const auto truth = testing::random_places(100, 4);
  ShakenParticles particles = testing::painted_particles(truth, kGrey, 5);
  for (std::size_t v = 0; v < 4; ++v) particles.set_sigma(v, 1.1);
  for (const Point3& place : truth) particles.push(place, kGrey);
  particles.subtract();
  for (int i = 0; i < 15; ++i) particles.sweep(), particles.fit_images();
  for (std::size_t v = 0; v < 4; ++v) {
    EXPECT_NEAR(particles.sigma_px(v), testing::kSmallSigma_px, 0.01);
    EXPECT_NEAR(particles.gain(v), 1, 0.01);
  }
}

TEST(ShakenParticles, that_no_image_shows_are_let_go_and_so_are_doubles) {
  const auto truth = testing::random_places(50, 6);
  const auto ghosts = testing::random_places(20, 7);
  ShakenParticles particles = testing::painted_particles(truth, kGrey, 20);
  for (const Point3& place : truth) particles.push(place, kGrey);
  for (const Point3& place : ghosts) particles.push(place, kGrey);
  particles.push(truth.front() + Point3{0.005, 0, 0}, kGrey / 2);
  particles.subtract();
  for (int i = 0; i < 12; ++i) particles.sweep();
  const std::size_t before = particles.all().size();
  const std::size_t went = particles.drop(0.3, 0.7);
  EXPECT_EQ(before - went, particles.all().size());
  EXPECT_EQ(particles.all().size(), truth.size());
}

TEST(ShakenParticles, are_the_same_with_any_number_of_threads) {
  const auto truth = testing::random_places(300, 9);
  ShakenParticles one = testing::painted_particles(truth, kGrey, 20, 1);
  ShakenParticles four = testing::painted_particles(truth, kGrey, 20, 4);
  for (ShakenParticles* particles : {&one, &four}) {
    for (const Point3& place : truth) particles->push(place + Point3{0.01, 0, 0}, kGrey);
    particles->subtract();
    for (int i = 0; i < 4; ++i) particles->sweep(), particles->fit_images();
  }
  for (std::size_t i = 0; i < truth.size(); ++i) EXPECT_EQ(one.all()[i].at_mm, four.all()[i].at_mm);
}

TEST(ShakenParticles, refuse_more_than_they_have_room_for) {
  ShakenParticles particles = testing::painted_particles({{0, 0, 0}}, kGrey, 20);
  EXPECT_TRUE(particles.push({0, 0, 0}, kGrey));
  EXPECT_TRUE(particles.push({0, 0, 1}, kGrey));
  EXPECT_FALSE(particles.push({0, 1, 0}, kGrey));
}

}  // namespace
}  // namespace rptv
