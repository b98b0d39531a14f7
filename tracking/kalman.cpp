// SPDX-License-Identifier: MIT
// The filter's arithmetic, block by block: H = [I 0 0] picks the position, so that most products vanish.
#include "tracking/kalman.hpp"

#include <cmath>
#include <limits>

namespace rptv {

namespace {

using Vector = std::array<double, 3>;

constexpr Block3 kIdentity{1, 0, 0, 0, 1, 0, 0, 0, 1};

Block3 product(const Block3& a, const Block3& b) noexcept {
  Block3 c;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
  return c;
}

Block3 transposed(const Block3& a) noexcept { return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]}; }

Block3 sum(const Block3& a, const Block3& b, double factor = 1) noexcept {
  Block3 c;
  for (std::size_t i = 0; i < 9; ++i) c[i] = a[i] + factor * b[i];
  return c;
}

void make_symmetric(Block3& a) noexcept {
  a[1] = a[3] = 0.5 * (a[1] + a[3]);
  a[2] = a[6] = 0.5 * (a[2] + a[6]);
  a[5] = a[7] = 0.5 * (a[5] + a[7]);
}

Block3 diagonal(double value) noexcept { return {value, 0, 0, 0, value, 0, 0, 0, value}; }

}  // namespace

Block3 full(const Covariance& c) noexcept { return {c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]}; }
Covariance upper(const Block3& a) noexcept { return {a[0], a[1], a[2], a[4], a[5], a[8]}; }

bool invert_symmetric(const Block3& a, Block3& inverse) noexcept {
  const double c00 = a[4] * a[8] - a[5] * a[5];
  const double c01 = a[2] * a[5] - a[1] * a[8];
  const double c02 = a[1] * a[5] - a[2] * a[4];
  const double determinant = a[0] * c00 + a[1] * c01 + a[2] * c02;
  const double minor = a[0] * a[4] - a[1] * a[1];
  if (!(a[0] > 0 && minor > 0 && determinant > 0 && std::isfinite(1 / determinant))) return false;
  const double scale = 1 / determinant;
  const double c12 = (a[1] * a[2] - a[0] * a[5]) * scale;
  inverse = {c00 * scale, c01 * scale, c02 * scale, c01 * scale,  (a[0] * a[8] - a[2] * a[2]) * scale,
             c12,         c02 * scale, c12,         minor * scale};
  return true;
}

double mahalanobis2(const Vector& d, const Block3& a) noexcept {
  Block3 inverse;
  if (!invert_symmetric(a, inverse)) return std::numeric_limits<double>::infinity();
  double sum2 = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) sum2 += d[i] * inverse[3 * i + j] * d[j];
  return sum2;
}

void KalmanState::begin(const Vector& position, const Block3& noise, const Vector& velocity) noexcept {
  x = {position, velocity, Vector{}};
  p = {};
  p[0] = noise;
  fresh = true;
}

void KalmanState::take_prior(const KalmanModel& model) noexcept {
  if (!fresh) return;
  p[block(1, 1)] = diagonal(model.velocity_prior_mm_s * model.velocity_prior_mm_s);
  if (model.order > 2) p[block(2, 2)] = diagonal(model.acceleration_mm_s2 * model.acceleration_mm_s2);
  fresh = false;
}

void KalmanState::predict(const KalmanModel& model, double dt) noexcept {
  const double half = 0.5 * dt * dt;
  take_prior(model);
  for (std::size_t k = 0; k < 3; ++k) {
    x[0][k] += dt * x[1][k] + half * x[2][k];
    x[1][k] += dt * x[2][k];
  }
  // F P, then (F P) Fᵀ, on the blocks above the diagonal; F = [1 dt half; 0 1 dt; 0 0 1] ⊗ I.
  const auto [p00, p01, p02, p11, p12, p22] = p;
  for (std::size_t i = 0; i < 9; ++i) {
    const std::size_t t = 3 * (i % 3) + i / 3;  // the transposed element
    const double a00 = p00[i] + dt * p01[t] + half * p02[t];
    const double a01 = p01[i] + dt * p11[i] + half * p12[t];
    const double a02 = p02[i] + dt * p12[i] + half * p22[i];
    const double a11 = p11[i] + dt * p12[t];
    const double a12 = p12[i] + dt * p22[i];
    p[0][i] = a00 + dt * a01 + half * a02;
    p[1][i] = a01 + dt * a02;
    p[2][i] = a02;
    p[3][i] = a11 + dt * a12;
    p[4][i] = a12;
  }
  const double q = model.acceleration_mm_s2 * model.acceleration_mm_s2;
  const Vector g{half, dt, 1};
  for (std::size_t i = 0; i < model.order; ++i)
    for (std::size_t j = i; j < model.order; ++j)
      for (std::size_t k = 0; k < 9; k += 4) p[block(i, j)][k] += q * g[i] * g[j];
}

bool KalmanState::update(const KalmanModel& model, const Vector& position, const Block3& noise) noexcept {
  Block3 inverse;
  if (!invert_symmetric(sum(p[0], noise), inverse)) return false;
  std::array<Block3, 3> gain{}, gain_t{}, to_position{};
  const Vector innovation{position[0] - x[0][0], position[1] - x[0][1], position[2] - x[0][2]};
  for (std::size_t i = 0; i < model.order; ++i) {
    gain[i] = product(transposed(p[block(0, i)]), inverse);
    gain_t[i] = transposed(gain[i]);
    for (std::size_t k = 0; k < 3; ++k)
      x[i][k] +=
          gain[i][3 * k] * innovation[0] + gain[i][3 * k + 1] * innovation[1] + gain[i][3 * k + 2] * innovation[2];
  }
  const Block3 rest = sum(kIdentity, gain[0], -1);
  const auto before = p;
  to_position[0] = product(rest, before[0]);
  for (std::size_t i = 1; i < model.order; ++i)
    to_position[i] = sum(transposed(before[block(0, i)]), product(gain[i], before[0]), -1);
  const Block3 rest_t = transposed(rest);
  p[0] = sum(product(to_position[0], rest_t), product(product(gain[0], noise), gain_t[0]));
  for (std::size_t j = 1; j < model.order; ++j) {
    for (std::size_t i = 0; i <= j; ++i) {
      const Block3 left = i == 0 ? product(rest, before[block(0, j)])
                                 : sum(before[block(i, j)], product(gain[i], before[block(0, j)]), -1);
      p[block(i, j)] =
          sum(sum(left, product(to_position[i], gain_t[j]), -1), product(product(gain[i], noise), gain_t[j]));
    }
    make_symmetric(p[block(j, j)]);
  }
  make_symmetric(p[0]);
  return true;
}

void KalmanState::replace_position(const Vector& position, const Block3& noise) noexcept {
  x[0] = position;
  p[0] = noise;
  p[1] = p[2] = Block3{};
}

}  // namespace rptv
