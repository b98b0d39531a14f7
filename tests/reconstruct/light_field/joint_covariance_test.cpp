// SPDX-License-Identifier: MIT
// Marginal covariances of overlapping particles against the dense inverse of all together.
#include "reconstruct/light_field/joint_covariance.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "reconstruct/light_field/cramer_rao.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

using testing::kRadiusMm;
using testing::small_camera;

constexpr double kLight = 3000, kDarkVariance = 0.5, kPerGrey = 0.2;
constexpr std::size_t kMostPixels = 1 << 16;

ImageModelOptions model_options(const LightFieldCalibration& camera) {
  ImageModelOptions model;
  model.pupil_radius_mm = 0.5 * camera.lens.exit_pupil_mm / camera.lens.image_f_number;
  model.particle_radius_mm = kRadiusMm;
  return model;
}

struct Overlapping {
  Overlapping(std::size_t particles, double half_mm, unsigned seed, std::size_t threads = 1)
      : camera(small_camera(256, 224)), lattice(camera), model(camera, lattice, model_options(camera)) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> aside(-half_mm, half_mm), depth(-14, 10), light(0.5, 1.5);
    JointImages images(particles, particles * kMostPixels / 4);
    images.begin(particles);
    std::vector<JointParticle> joint;
    std::vector<float> weight(256 * 224), rest(256 * 224);
    ParticleImage image(kMostPixels);
    for (std::size_t k = 0; k < particles; ++k) {
      const ImagePoint at{aside(random), aside(random), depth(random)};
      joint.push_back({at, kLight * light(random)}), points.push_back({at, joint.back().light});
      EXPECT_TRUE(model.render(at, image) && images.put(k, image));
      images.paint(k, joint.back().light, weight);
    }
    for (float& w : weight) w = static_cast<float>(1 / (kDarkVariance + kPerGrey * static_cast<double>(w)));
    JointNormal normal(weight.size(), particles, particles * kMostPixels / 4, threads);
    normal.assemble(images, joint, weight, rest, 1e30);
    JointCovariance covariance(particles, normal.max_blocks(), threads);
    spreads.resize(particles);
    covariance.find(normal, spreads);
  }
  LightFieldCalibration camera;
  LensletLattice lattice;
  ImageModel model;
  std::vector<BrightPoint> points;
  std::vector<JointSpread> spreads;
};

std::array<double, 3> variances(const FitCovariance& c) { return {c.xx, c.yy, c.zz}; }

// In single precision: what is lost grows with how much wider the neighbours make it.
RC_GTEST_PROP(JointCovariance, is_the_block_of_the_dense_inverse, (std::uint8_t seed)) {
  const auto particles = *rc::gen::inRange<std::size_t>(1, 40);
  const double half_mm = *rc::gen::element(0.15, 0.3, 0.5);
  Overlapping scene(particles, half_mm, seed);
  const auto exact = cramer_rao_bounds(scene.model, scene.points, {kDarkVariance, kPerGrey});
  for (std::size_t k = 0; k < particles; ++k) {
    const auto& [alone, shared, cut] = scene.spreads[k];
    RC_ASSERT(!cut);
    const auto a = variances(alone), s = variances(shared), e = variances(exact[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      RC_ASSERT(s[axis] >= 0);
      RC_ASSERT(std::abs((a[axis] + s[axis]) / e[axis] - 1) < 0.01 + 0.002 * e[axis] / a[axis]);
    }
  }
}

// A crowd of which a group holds a third: rather too wide than too narrow.
TEST(JointCovariance, tells_where_a_group_is_cut_and_widens_it) {
  Overlapping scene(190, 0.45, 1);
  const auto exact = cramer_rao_bounds(scene.model, scene.points, {kDarkVariance, kPerGrey});
  for (std::size_t k = 0; k < exact.size(); ++k) {
    const auto& [alone, shared, cut] = scene.spreads[k];
    EXPECT_TRUE(cut) << k;
    EXPECT_GE((alone.zz + shared.zz) / exact[k].zz, 0.9) << k;
    EXPECT_LE((alone.zz + shared.zz) / exact[k].zz, 4) << k;
  }
}

// Of a particle in the sensor's corner a pixel or two are left, which do not tell four numbers.
TEST(JointCovariance, stays_a_number_beside_a_particle_that_hardly_lights_the_sensor) {
  JointImages images(2, kMostPixels);
  images.begin(2);
  const std::vector<JointParticle> joint{{{0, 0, 5}, kLight}, {{0.1, 0, 5}, kLight}};
  ParticleImage whole(4), crumb(4);
  whole.size = 4, crumb.size = 1;
  for (std::uint32_t i = 0; i < 4; ++i) {
    whole.pixel[i] = i, whole.value[i] = 0.2F;
    whole.dx[i] = i == 0 ? 1.0F : 0.1F, whole.dy[i] = i == 1 ? 1.0F : -0.1F, whole.dz[i] = i == 2 ? 0.1F : 0.01F;
  }
  crumb.pixel[0] = 3, crumb.value[0] = 0.3F, crumb.dx[0] = 0.7F, crumb.dy[0] = -1.3F, crumb.dz[0] = 0.09F;
  ASSERT_TRUE(images.put(0, whole) && images.put(1, crumb));
  const std::vector<float> weight(4, 0.02F), rest(4);
  JointNormal normal(4, 2, kMostPixels, 1);
  normal.assemble(images, joint, weight, rest, 1e30);
  JointCovariance covariance(2, normal.max_blocks(), 1);
  std::vector<JointSpread> both(2);
  covariance.find(normal, both);
  for (const auto& spread : both)
    for (const double variance : variances(spread.alone)) EXPECT_TRUE(std::isfinite(variance) && variance > 0);
  for (const double variance : variances(both[0].shared)) EXPECT_TRUE(std::isfinite(variance));
}

TEST(JointCovariance, does_not_depend_on_the_number_of_threads) {
  const Overlapping one(60, 0.4, 2, 1), three(60, 0.4, 2, 3);
  for (std::size_t k = 0; k < one.spreads.size(); ++k) {
    EXPECT_EQ(variances(one.spreads[k].shared), variances(three.spreads[k].shared));
    EXPECT_EQ(variances(one.spreads[k].alone), variances(three.spreads[k].alone));
  }
}

}  // namespace
}  // namespace rptv
