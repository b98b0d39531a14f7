// SPDX-License-Identifier: MIT
// Low-discrepancy points in discs.
#include "simulation/quadrature.hpp"

#include <cmath>
#include <numbers>

namespace rptv {

namespace {

double fraction(double value) { return value - std::floor(value); }

RaySample sample(double pupil, double pupil_angle, double body, double body_angle) {
  return {static_cast<float>(pupil * std::cos(pupil_angle)), static_cast<float>(pupil * std::sin(pupil_angle)),
          static_cast<float>(body * std::cos(body_angle)), static_cast<float>(body * std::sin(body_angle))};
}

}  // namespace

std::vector<RaySample> particle_samples(std::size_t count) {
  constexpr double kRoot = 1.1673039782614187;  // of x^5 = x + 1
  std::vector<RaySample> samples;
  samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i) + 0.5;
    const double pupil = std::sqrt(fraction(n / kRoot));
    const double pupil_angle = 2 * std::numbers::pi * fraction(n / std::pow(kRoot, 2));
    const double body = std::sqrt(fraction(n / std::pow(kRoot, 3)));
    const double body_angle = 2 * std::numbers::pi * fraction(n / std::pow(kRoot, 4));
    samples.push_back(sample(pupil, pupil_angle, body, body_angle));
  }
  return samples;
}

std::vector<RaySample> lenslet_samples(std::size_t count) {
  constexpr double kPlastic = 1.324717957244746;  // root of x^3 = x + 1
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<RaySample> samples;
  samples.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto n = static_cast<double>(i) + 0.5;
    samples.push_back(sample(std::sqrt(n / static_cast<double>(count)), golden * n, std::sqrt(fraction(n / kPlastic)),
                             2 * std::numbers::pi * fraction(n / (kPlastic * kPlastic))));
  }
  return samples;
}

}  // namespace rptv
