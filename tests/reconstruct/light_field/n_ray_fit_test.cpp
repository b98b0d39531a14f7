// SPDX-License-Identifier: MIT
// N-ray least squares against Eigen's, and its covariance against scattered repetitions.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "reconstruct/light_field/fit_covariance_kernel.hpp"
#include "reconstruct/light_field/n_ray_fit_kernel.hpp"
#include "reconstruct/light_field/ray_gate_kernel.hpp"
#include "reconstruct/light_field/ray_sums.hpp"

namespace rptv {
namespace {

struct WeightedRay {
  Ray ray;
  double weight;
};

std::vector<WeightedRay> random_rays(unsigned seed, double noise) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1, 1);
  const double x = 3 * unit(random), y = 3 * unit(random), z = 20 * unit(random);
  std::vector<WeightedRay> rays;
  for (int i = 0; i < 60; ++i) {
    const double sx = 0.04 + 0.016 * unit(random), sy = -0.02 + 0.016 * unit(random);
    rays.push_back(
        {{static_cast<float>(x - sx * z + noise * normal(random)),
          static_cast<float>(y - sy * z + noise * normal(random)), static_cast<float>(sx), static_cast<float>(sy)},
         1 + unit(random) / 2});
  }
  return rays;
}

RaySums sums_of(const std::vector<WeightedRay>& rays, const ImagePoint& from) {
  RaySums sums;
  for (const auto& [ray, weight] : rays) sums.add(ray, offset_of(ray, from), weight);
  return sums;
}

TEST(NRayFit, is_the_weighted_least_squares_point) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const auto rays = random_rays(seed, 0.04);
    const auto n = static_cast<Eigen::Index>(rays.size());
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(2 * n, 3);
    Eigen::VectorXd b(2 * n);
    for (Eigen::Index i = 0; i < n; ++i) {  // x - s_x·z = c_x, y - s_y·z = c_y
      const auto& [ray, weight] = rays[static_cast<std::size_t>(i)];
      const double root = std::sqrt(weight);
      a(2 * i, 0) = a(2 * i + 1, 1) = root;
      a(2 * i, 2) = -root * static_cast<double>(ray.slope_x),
               a(2 * i + 1, 2) = -root * static_cast<double>(ray.slope_y);
      b(2 * i) = root * static_cast<double>(ray.centre_x), b(2 * i + 1) = root * static_cast<double>(ray.centre_y);
    }
    const Eigen::Vector3d expected = a.colPivHouseholderQr().solve(b);
    Eigen::VectorXd misses = -b;
    misses.noalias() += a * expected;
    for (const ImagePoint from : {ImagePoint{}, ImagePoint{expected[0] + 0.1, expected[1], expected[2] - 2}}) {
      const RayFit fit = solve(sums_of(rays, from), 0, from.z);
      EXPECT_NEAR(from.x + fit.dx, expected[0], 1e-9);
      EXPECT_NEAR(from.y + fit.dy, expected[1], 1e-9);
      EXPECT_NEAR(from.z + fit.dz, expected[2], 1e-7);
      EXPECT_NEAR(fit.wrr, misses.squaredNorm(), 1e-9);
    }
    const Eigen::Matrix3d inverse = (a.transpose() * a).inverse();
    const RayFit fit = solve(sums_of(rays, {}), 0, 0);
    EXPECT_NEAR(1 / fit.slope_spread, inverse(2, 2), 1e-6 * inverse(2, 2));
  }
}

TEST(NRayFit, leaves_the_depth_alone_when_all_rays_are_parallel_or_there_is_one) {
  RaySums sums;
  for (int i = 0; i < 5; ++i) {
    const Ray ray{0.1F * static_cast<float>(i), 0, 0.03F, -0.01F};
    sums.add(ray, offset_of(ray, {0, 0, 7}), 1);
    const RayFit fit = solve(sums, 0, 7);
    EXPECT_EQ(fit.dz, 0);
    EXPECT_EQ(fit.slope_spread, 0);
    EXPECT_TRUE(std::isfinite(fit.dx) && std::isfinite(fit.dy) && std::isfinite(fit.wrr));
  }
  EXPECT_EQ(solve(RaySums{}, 0, 0).slope_spread, 0);
}

TEST(NRayFit, puts_back_the_depth_that_blurred_slopes_lose) {
  std::mt19937 random(4);
  std::normal_distribution<double> blur(0, 0.003);
  std::uniform_real_distribution<double> unit(-1, 1);
  RaySums sums;
  const double z = 25;
  for (int i = 0; i < 20000; ++i) {
    const double sx = 0.016 * unit(random), sy = 0.016 * unit(random);
    const Ray ray{static_cast<float>(-sx * z), static_cast<float>(-sy * z), static_cast<float>(sx + blur(random)),
                  static_cast<float>(sy + blur(random))};
    sums.add(ray, offset_of(ray, {0, 0, 20}), 1);
  }
  EXPECT_LT(20 + solve(sums, 0, 20).dz, 0.93 * z);
  EXPECT_NEAR(20 + solve(sums, 0.003 * 0.003, 20).dz, z, 0.01 * z);
}

// Rays of one lenslet share its error: the covariance has to see that, and match what repeated trials scatter.
TEST(FitCovariance, matches_the_scatter_of_trials_with_errors_shared_within_lenslets) {
  std::mt19937 random(8);
  std::normal_distribution<double> error(0, 0.05);
  std::uniform_real_distribution<double> unit(-1, 1);
  Eigen::Matrix3d scattered = Eigen::Matrix3d::Zero(), stated = Eigen::Matrix3d::Zero();
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<Ray> rays;
    const double z = 15;
    for (int lenslet = 0; lenslet < 40; ++lenslet) {
      const double sx = 0.03 + 0.016 * unit(random), sy = -0.05 + 0.016 * unit(random), ex = error(random),
                   ey = error(random);
      for (int i = 0; i < 5; ++i) {
        const double tx = sx + 0.001 * unit(random), ty = sy + 0.001 * unit(random);
        rays.push_back({static_cast<float>(-sx * z + ex), static_cast<float>(-sy * z + ey), static_cast<float>(tx),
                        static_cast<float>(ty)});
      }
    }
    const ImagePoint from{0, 0, z};
    RaySums sums;
    for (const Ray& ray : rays) sums.add(ray, offset_of(ray, from), 1);
    const RayFit fit = solve(sums, 0, z);
    LensletScores scores;
    for (const Ray& ray : rays) scores.add(ray, offset_of(ray, {fit.dx, fit.dy, z + fit.dz}));
    scores.close();
    ASSERT_EQ(scores.lenslets, 40);
    const FitCovariance c = covariance_of(sums, fit, scores, 0);
    const Eigen::Vector3d e(fit.dx, fit.dy, fit.dz);
    scattered += e * e.transpose() / kTrials;
    Eigen::Matrix3d m;
    m << c.xx, c.xy, c.xz, c.xy, c.yy, c.yz, c.xz, c.yz, c.zz;
    stated += m / kTrials;
  }
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      EXPECT_NEAR(stated(row, column), scattered(row, column),
                  0.15 * std::sqrt(scattered(row, row) * scattered(column, column)))
          << row << column;
}

TEST(RayGate, is_a_square_turned_like_the_lenslets_that_widens_with_depth) {
  const double turn = 0.3;
  const RayGate gate{std::cos(turn), std::sin(turn), 0.1, 0.001};
  EXPECT_NEAR(gate.distance({0.1 * std::cos(turn), 0.1 * std::sin(turn)}), 0.1, 1e-12);
  const double diagonal = 0.1 * std::sqrt(2.0);
  EXPECT_NEAR(gate.distance({diagonal * std::cos(turn + 0.785398163), diagonal * std::sin(turn + 0.785398163)}), 0.1,
              1e-9);
  EXPECT_NEAR(gate.half_width_at(-20), 0.12, 1e-12);
}

TEST(RaySums, over_many_rays_are_those_ray_by_ray) {
  std::mt19937 random(8);
  std::uniform_real_distribution<float> centre(-0.2F, 0.2F), slope(-0.016F, 0.016F);
  for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 100U, 1000U}) {
    RayColumns columns(count);
    RaySums expected;
    const RayGate gate{std::cos(0.3), std::sin(0.3), 0.0825, 0.0006};
    const ImagePoint at{4.02, -3.01, 7.5};
    std::size_t inside = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const Ray ray{4.0F + centre(random), -3.0F + centre(random), slope(random), slope(random)};
      columns.push(ray);
      const RayOffset r = offset_of(ray, at);
      if (gate.distance(r) > gate.half_width_at(at.z)) continue;
      expected.add(ray, r, 1.0);
      ++inside;
    }
    const RaySums sums = sum_rays(columns, gate, at, gate.half_width_at(at.z));
    const double n = static_cast<double>(inside) + 1;
    EXPECT_EQ(sums.w, expected.w);
    EXPECT_NEAR(sums.ws_x, expected.ws_x, 1e-7 * n);
    EXPECT_NEAR(sums.wss, expected.wss, 1e-9 * n);
    EXPECT_NEAR(sums.wr_y, expected.wr_y, 1e-6 * n);
    EXPECT_NEAR(sums.wrs, expected.wrs, 1e-8 * n);
    EXPECT_NEAR(sums.wrr, expected.wrr, 1e-7 * n);
  }
}

}  // namespace
}  // namespace rptv
