// SPDX-License-Identifier: MIT
// The Cramér-Rao bound's laws, and the likelihood that steps climb.
#include "reconstruct/light_field/cramer_rao.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "reconstruct/light_field/poisson_gain_kernel.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

using testing::kRadiusMm;
using testing::small_camera;

struct Camera {
  Camera()
      : lattice(small_camera()),
        model(small_camera(), lattice,
              {.pupil_radius_mm = 0.5 * small_camera().lens.exit_pupil_mm / small_camera().lens.image_f_number,
               .particle_radius_mm = kRadiusMm}) {}
  double depth_variance(const std::vector<BrightPoint>& particles, const PixelNoise& noise) {
    return cramer_rao_bounds(model, particles, noise).at(0).zz;
  }
  LensletLattice lattice;
  ImageModel model;
};

TEST(CramerRaoBound, falls_with_the_light_under_shot_noise_and_with_its_square_under_read_noise) {
  Camera camera;
  const PixelNoise shot{1e-6, 0.2}, read{1, 0};
  const BrightPoint faint{{0.1, 0.05, 8}, 1000}, bright{{0.1, 0.05, 8}, 4000};
  EXPECT_NEAR(camera.depth_variance({faint}, shot) / camera.depth_variance({bright}, shot), 4, 0.05);
  EXPECT_NEAR(camera.depth_variance({faint}, read) / camera.depth_variance({bright}, read), 16, 0.01);
}

TEST(CramerRaoBound, grows_where_a_neighbour_shares_the_pixels_and_only_there) {
  Camera camera;
  const PixelNoise noise{0.5, 0.2};
  const BrightPoint particle{{0.1, 0.05, 8}, 3000}, near{{0.16, 0.05, 7}, 3000}, far{{-1.4, -0.9, 7}, 3000};
  const double alone = camera.depth_variance({particle}, noise);
  EXPECT_GT(camera.depth_variance({particle, near}, noise), 1.2 * alone);
  EXPECT_NEAR(camera.depth_variance({particle, far}, noise), alone, 1e-6 * alone);
}

TEST(CramerRaoBound, is_infinite_off_the_sensor) {
  Camera camera;
  EXPECT_TRUE(std::isinf(camera.depth_variance({{{9, 9, 8}, 3000}}, {1, 0.2})));
}

TEST(PoissonGain, has_the_derivative_of_weighted_least_squares_and_its_maximum_at_what_is_seen) {
  for (const float seen : {0.4F, 3.0F, 50.0F})
    for (const float expected : {0.5F, 2.0F, 40.0F}) {
      const float step = 1e-2F * expected;
      const float slope =
          (poisson_gain(seen, expected + step, 0.3F) - poisson_gain(seen, expected - step, 0.3F)) / (2 * step);
      EXPECT_NEAR(slope, 2 * (seen - expected) / expected, 0.02 * (1 + std::abs(slope)));
      EXPECT_LE(poisson_gain(seen, expected, 0.3F), poisson_gain(seen, seen, 0.3F) + 1e-4F);
    }
  for (float x = 1e-6F; x < 1e6F; x *= 1.37F) EXPECT_NEAR(log_of_positive(x), std::log(x), 2e-6F) << x;
}

}  // namespace
}  // namespace rptv
