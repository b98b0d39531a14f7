// SPDX-License-Identifier: MIT
// The filter against a dense one, and its covariances against the errors that they promise.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "tests/tracking/simulated_motion.hpp"
#include "tracking/kalman.hpp"

namespace rptv {
namespace {

using Dense = Eigen::MatrixXd;

Dense dense(const KalmanState& state, std::size_t order) {
  const auto n = static_cast<Eigen::Index>(3 * order);
  Dense p(n, n);
  for (std::size_t row = 0; row < order; ++row)
    for (std::size_t column = row; column < order; ++column)
      for (std::size_t k = 0; k < 9; ++k) {
        const auto i = static_cast<Eigen::Index>(3 * row + k / 3);
        const auto j = static_cast<Eigen::Index>(3 * column + k % 3);
        p(i, j) = p(j, i) = state.p[KalmanState::block(row, column)][k];
      }
  return p;
}

Eigen::VectorXd vector_of(const std::array<std::array<double, 3>, 3>& x, std::size_t order) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(3 * order));
  for (std::size_t i = 0; i < 3 * order; ++i) v(static_cast<Eigen::Index>(i)) = x[i / 3][i % 3];
  return v;
}

TEST(Kalman, does_what_the_dense_filter_does) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  for (const std::size_t order : {2U, 3U}) {
    const KalmanModel model{order, 0.7, 1.5};
    const auto n = static_cast<Eigen::Index>(3 * order);
    KalmanState state;
    state.begin({0, 0, 0}, full({0.04, 0.01, 0, 0.05, 0.01, 0.2}), {0.1, 0, 0});
    state.predict(model, 0.1);
    Eigen::VectorXd x = vector_of(state.x, order);
    Dense p = dense(state, order);
    for (int step = 0; step < 40; ++step) {
      const double dt = 0.1 + 0.05 * (step % 3);
      Dense f = Dense::Identity(n, n);
      Dense g = Dense::Zero(n, 3);
      for (Eigen::Index k = 0; k < 3; ++k) {
        f(k, 3 + k) = dt;
        g(k, k) = dt * dt / 2;
        g(3 + k, k) = dt;
        if (order < 3) continue;
        f(k, 6 + k) = dt * dt / 2;
        f(3 + k, 6 + k) = dt;
        g(6 + k, k) = 1;
      }
      x = f * x;
      p = f * p * f.transpose() + 0.49 * g * g.transpose();
      const std::array<double, 3> z{normal(random), normal(random), normal(random)};
      const Covariance r{0.04, 0.01, 0.002, 0.05, 0.01, 0.2 + 0.1 * std::abs(normal(random))};
      Dense h = Dense::Zero(3, n);
      h.leftCols(3).setIdentity();
      Dense noise(3, 3);
      noise << r[0], r[1], r[2], r[1], r[3], r[4], r[2], r[4], r[5];
      const Dense gain = p * h.transpose() * (h * p * h.transpose() + noise).inverse();
      x += gain * (Eigen::Vector3d(z[0], z[1], z[2]) - h * x);
      const Dense rest = Dense::Identity(n, n) - gain * h;
      p = rest * p * rest.transpose() + gain * noise * gain.transpose();
      state.predict(model, dt);
      ASSERT_TRUE(state.update(model, z, full(r)));
      ASSERT_LT((vector_of(state.x, order) - x).norm(), 1e-9 * (1 + x.norm()));
      ASSERT_LT((dense(state, order) - p).norm(), 1e-9 * p.norm());
    }
  }
}

/// Mean of eᵀ P⁻¹ e over many runs is the number of states, if the covariance is right (Bar-Shalom 2001, sec. 5.4).
TEST(Kalman, promises_the_errors_that_it_makes) {
  constexpr int kRuns = 400;
  for (const std::size_t order : {2U, 3U}) {
    const KalmanModel model{order, 3.0, 5.0};
    double sum_early = 0, sum_late = 0;
    for (unsigned run = 0; run < kRuns; ++run) {
      SimulatedMotion particle(model, run);
      KalmanState state;
      state.begin(particle.measured(), full(kNoise), {});
      for (int step = 1; step <= 40; ++step) {
        const double dt = step % 7 == 0 ? 0.3 : 0.1;
        particle.move(dt);
        state.predict(model, dt);
        ASSERT_TRUE(state.update(model, particle.measured(), full(kNoise)));
        const Eigen::VectorXd e = vector_of(state.x, order) - vector_of(particle.x, order);
        const double nees = e.dot(dense(state, order).ldlt().solve(e));
        if (step == 3) sum_early += nees;
        if (step == 40) sum_late += nees;
      }
    }
    const auto states = static_cast<double>(3 * order);
    const double four_sigma = 4 * std::sqrt(2 * states / kRuns);
    EXPECT_NEAR(sum_early / kRuns, states, four_sigma) << "order " << order;
    EXPECT_NEAR(sum_late / kRuns, states, four_sigma) << "order " << order;
  }
}

TEST(Kalman, stays_symmetric_and_positive_however_long_it_runs) {
  const KalmanModel model{3, 1e-6, 10};
  KalmanState state;
  state.begin({1e3, -1e3, 0}, full({1e-8, 0, 0, 1e-8, 0, 1}), {});
  for (int step = 0; step < 100'000; ++step) {
    state.predict(model, 1e-3);
    ASSERT_TRUE(state.update(model, {1e3, -1e3, 0}, full({1e-8, 0, 0, 1e-8, 0, 1})));
  }
  const Dense p = dense(state, 3);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Dense>(p).eigenvalues().minCoeff(), -1e-12 * p.norm());
  EXPECT_EQ(p, p.transpose());
}

TEST(Kalman, refuses_an_innovation_that_has_no_inverse) {
  KalmanState state;
  state.begin({1, 2, 3}, Block3{}, {});
  const KalmanState before = state;
  EXPECT_FALSE(state.update(KalmanModel{2, 1, 1}, {2, 2, 2}, Block3{}));
  EXPECT_EQ(state.x, before.x);
  EXPECT_TRUE(std::isinf(mahalanobis2({1, 0, 0}, Block3{})));
}

TEST(Kalman, measures_distance_in_standard_deviations) {
  EXPECT_NEAR(mahalanobis2({0.3, 0, 0}, full({0.01, 0, 0, 1, 0, 1})), 9, 1e-12);
  EXPECT_NEAR(mahalanobis2({1, 1, 0}, full({1, 0.5, 0, 1, 0, 1})), 4.0 / 3, 1e-12);
}

}  // namespace
}  // namespace rptv
