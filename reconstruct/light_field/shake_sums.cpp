// SPDX-License-Identifier: MIT
// Sums in eight lanes, so that the compiler may use vectors and the result does not depend on which.
#include "reconstruct/light_field/shake_sums.hpp"

#include <algorithm>

#include "reconstruct/light_field/poisson_gain_kernel.hpp"

namespace rptv {

namespace {

constexpr std::size_t kLanes = 8;
using Lanes = std::array<float, kLanes>;

// Without shot noise; the others' light may lie somewhat elsewhere.
float still_variance_of(const Seen& seen, std::size_t i) noexcept {
  const float misfit = seen.misfit * seen.others[i];
  return seen.dark_variance + misfit * misfit;
}

float variance_of(const Seen& seen, std::size_t i, float grey) noexcept {
  return still_variance_of(seen, i) + seen.variance_per_grey * std::max(seen.others[i] + grey, 0.0F);
}

double total(const Lanes& lanes) noexcept {
  double sum = 0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

}  // namespace

ShakeSums sum_up(const ParticleImage& image, const Seen& seen, double light) noexcept {
  std::array<Lanes, 16> lanes{};
  const auto l = static_cast<float>(light);
  for (std::size_t first = 0; first < image.size; first += kLanes) {
    const std::size_t count = std::min(kLanes, image.size - first);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t i = first + k;
      const float value = image.value[i], grey = seen.grey[i];
      const float expected = l * value, rest = grey - expected;
      const float without = variance_of(seen, i, 0), with = variance_of(seen, i, expected);
      const float weight = 1 / with;
      const float x = l * image.dx[i], y = l * image.dy[i], z = l * image.dz[i];
      const float w_x = weight * x, w_y = weight * y, w_z = weight * z, w_v = weight * value, w_r = weight * rest;
      lanes[0][k] += w_x * x, lanes[1][k] += w_x * y, lanes[2][k] += w_x * z, lanes[3][k] += w_x * value;
      lanes[4][k] += w_y * y, lanes[5][k] += w_y * z, lanes[6][k] += w_y * value;
      lanes[7][k] += w_z * z, lanes[8][k] += w_z * value, lanes[9][k] += w_v * value;
      lanes[10][k] += w_r * x, lanes[11][k] += w_r * y, lanes[12][k] += w_r * z, lanes[13][k] += w_r * value;
      lanes[14][k] += poisson_gain(variance_of(seen, i, grey), with, without);
      lanes[15][k] += w_r * rest;
    }
  }
  ShakeSums sums;
  for (std::size_t i = 0; i < 10; ++i) sums.normal[i] = total(lanes[i]);
  for (std::size_t i = 0; i < 4; ++i) sums.pull[i] = total(lanes[10 + i]);
  const auto per_grey = static_cast<double>(seen.variance_per_grey);
  sums.gain = total(lanes[14]) / (per_grey * per_grey);
  sums.square = total(lanes[15]);
  return sums;
}

BestLight best_light(const ParticleImage& image, const Seen& seen) noexcept {
  double along = 0, square = 0;
  for (std::size_t i = 0; i < image.size; ++i) {
    // The light is not known yet: that which is seen, so that a dark pixel is not taken too seriously.
    const float weight = 1 / variance_of(seen, i, std::max(seen.grey[i], 0.0F));
    along += static_cast<double>(weight * image.value[i] * seen.grey[i]);
    square += static_cast<double>(weight * image.value[i] * image.value[i]);
  }
  if (!(square > 0)) return {0, 0};
  return {along / square, along * along / square};
}

}  // namespace rptv
