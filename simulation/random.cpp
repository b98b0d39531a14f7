// SPDX-License-Identifier: MIT
// Poisson and normal deviates.
#include "simulation/random.hpp"

#include <numbers>
#include <vector>

namespace rptv {

namespace {

/// log(k!), Stirling's series from 10 on (std::lgamma writes a global).
double log_factorial(double k) noexcept {
  static constexpr std::array<double, 10> kSmall{0.0,
                                                 0.0,
                                                 0.69314718055994531,
                                                 1.79175946922805500,
                                                 3.17805383034794562,
                                                 4.78749174278204599,
                                                 6.57925121201010100,
                                                 8.52516136106541430,
                                                 10.60460290274525023,
                                                 12.80182748008146961};
  if (k < 10) return kSmall[static_cast<std::size_t>(k)];
  const double inverse = 1.0 / k;
  return (k + 0.5) * std::log(k) - k + 0.5 * std::log(2.0 * std::numbers::pi) +
         inverse * (1.0 / 12.0 - inverse * inverse * (1.0 / 360.0 - inverse * inverse / 1260.0));
}

std::uint32_t poisson_small(Random& random, double mean) noexcept {
  double rest = random.uniform();
  double share = std::exp(-mean);
  std::uint32_t k = 0;
  while (rest >= share && k < 200) {
    rest -= share;
    share *= mean / ++k;
  }
  return k;
}

std::uint32_t poisson_large(Random& random, double mean) noexcept {
  const double log_mean = std::log(mean);
  const double b = 0.931 + 2.53 * std::sqrt(mean);
  const double a = -0.059 + 0.02483 * b;
  const double inverse_alpha = 1.1239 + 1.1328 / (b - 3.4);
  const double v_r = 0.9277 - 3.6224 / (b - 2.0);
  while (true) {
    const double u = random.uniform() - 0.5;
    const double v = random.uniform();
    const double us = 0.5 - std::abs(u);
    const double k = std::floor((2.0 * a / us + b) * u + mean + 0.43);
    if (us >= 0.07 && v <= v_r) return static_cast<std::uint32_t>(k);
    if (k < 0 || (us < 0.013 && v > us)) continue;
    if (std::log(v * inverse_alpha / (a / (us * us) + b)) <= k * log_mean - mean - log_factorial(k))
      return static_cast<std::uint32_t>(k);
  }
}

/// Quantile of the normal distribution by Newton steps on erfc, to double precision for the shares used here.
double normal_quantile(double share, double start) noexcept {
  double x = start;
  for (int step = 0; step < 60; ++step) {
    const double error = 0.5 * std::erfc(-x / std::numbers::sqrt2) - share;
    const double slope = std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi);
    const double change = error / (slope + 1e-300) / (1.0 + 0.5 * x * error / (slope + 1e-300));  // Halley
    x -= change;
    if (std::abs(change) < 1e-13) break;
  }
  return x;
}

std::vector<float> make_normal_table() {
  constexpr std::size_t kCells = 1U << 16;
  std::vector<double> upper(kCells / 2);
  double start = 0, squares = 0;
  for (std::size_t i = 0; i < upper.size(); ++i) {  // from the middle outwards: each start is near its solution
    const double share = 0.5 + (static_cast<double>(i) + 0.5) / static_cast<double>(kCells);
    start = upper[i] = normal_quantile(share, start);
    squares += upper[i] * upper[i];
  }
  const double scale = 1.0 / std::sqrt(squares / static_cast<double>(upper.size()));
  std::vector<float> table(kCells);
  for (std::size_t i = 0; i < upper.size(); ++i) {
    table[kCells / 2 + i] = static_cast<float>(upper[i] * scale);
    table[kCells / 2 - 1 - i] = static_cast<float>(-upper[i] * scale);
  }
  return table;
}

}  // namespace

std::uint32_t Random::poisson(double mean) noexcept {
  if (!(mean > 0)) return 0;
  return mean < 12 ? poisson_small(*this, mean) : poisson_large(*this, mean);
}

const float* normal_table() {
  static const std::vector<float> table = make_normal_table();
  return table.data();
}

}  // namespace rptv
