// SPDX-License-Identifier: MIT
// A particle that moves exactly as a Kalman model says, measured with a known covariance.
#pragma once

#include <array>
#include <cmath>
#include <random>

#include "tracking/kalman.hpp"

namespace rptv {

/// Covariance of the measurements, mm²: depth is worse than x and y, and leans on x.
inline constexpr Covariance kNoise{0.04, 0, 0.03, 0.04, 0, 0.25};

class SimulatedMotion {
 public:
  SimulatedMotion(const KalmanModel& model, unsigned seed) : model_(model), random_(seed) {
    for (std::size_t k = 0; k < 3; ++k) {
      x[1][k] = model.velocity_prior_mm_s * normal_(random_);
      if (model.order > 2) x[2][k] = model.acceleration_mm_s2 * normal_(random_);
    }
  }
  void move(double dt_s) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double w = model_.acceleration_mm_s2 * normal_(random_);  // an acceleration, or its change
      x[0][k] += dt_s * x[1][k] + dt_s * dt_s / 2 * (x[2][k] + w);
      x[1][k] += dt_s * (x[2][k] + w);
      if (model_.order > 2) x[2][k] += w;
    }
  }
  std::array<double, 3> measured() {
    const double a = normal_(random_), b = normal_(random_), c = normal_(random_);
    return {x[0][0] + 0.2 * a, x[0][1] + 0.2 * b, x[0][2] + 0.15 * a + std::sqrt(0.25 - 0.15 * 0.15) * c};
  }

  std::array<std::array<double, 3>, 3> x{};  ///< position, velocity, acceleration

 private:
  KalmanModel model_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

}  // namespace rptv
