// SPDX-License-Identifier: MIT
// Terms, derivatives and inverse of the Soloff polynomial.
#include "calibration/light_field/soloff_polynomial.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

struct Powers {
  int x, y, z;
};
constexpr std::array<Powers, kSoloffTerms> kPowers{{{0, 0, 0},
                                                    {1, 0, 0},
                                                    {0, 1, 0},
                                                    {0, 0, 1},
                                                    {2, 0, 0},
                                                    {1, 1, 0},
                                                    {0, 2, 0},
                                                    {1, 0, 1},
                                                    {0, 1, 1},
                                                    {0, 0, 2},
                                                    {3, 0, 0},
                                                    {2, 1, 0},
                                                    {1, 2, 0},
                                                    {0, 3, 0},
                                                    {2, 0, 1},
                                                    {1, 1, 1},
                                                    {0, 2, 1},
                                                    {1, 0, 2},
                                                    {0, 1, 2}}};

double power(double base, int exponent) noexcept {
  double result = 1;
  for (int k = 0; k < exponent; ++k) result *= base;
  return result;
}

double sum(const SoloffTerms& factors, const SoloffTerms& terms) noexcept {
  double total = 0;
  for (std::size_t k = 0; k < kSoloffTerms; ++k) total += factors[k] * terms[k];
  return total;
}

/// Cramer's rule; false when the matrix is singular.
bool solve(const Matrix3& m, const Point3& right, Point3& x) noexcept {
  const auto determinant = [](const Matrix3& a) {
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
  };
  const double whole = determinant(m);
  if (!(std::abs(whole) > 1e-300)) return false;
  for (std::size_t column = 0; column < 3; ++column) {
    Matrix3 replaced = m;
    for (std::size_t row = 0; row < 3; ++row) replaced[row][column] = right[row];
    x[column] = determinant(replaced) / whole;
  }
  return true;
}

}  // namespace

SoloffTerms soloff_terms(const Point3& p) noexcept {
  SoloffTerms terms{};
  for (std::size_t k = 0; k < kSoloffTerms; ++k)
    terms[k] = power(p[0], kPowers[k].x) * power(p[1], kPowers[k].y) * power(p[2], kPowers[k].z);
  return terms;
}

SoloffTerms soloff_slopes(const Point3& p, std::size_t axis) noexcept {
  SoloffTerms slopes{};
  for (std::size_t k = 0; k < kSoloffTerms; ++k) {
    const std::array<int, 3> powers{kPowers[k].x, kPowers[k].y, kPowers[k].z};
    double slope = powers[axis];
    for (std::size_t d = 0; d < 3; ++d) slope *= power(p[d], std::max(0, powers[d] - (d == axis ? 1 : 0)));
    slopes[k] = slope;
  }
  return slopes;
}

SoloffPolynomial::SoloffPolynomial(const PolynomialCalibration& calibration) {
  for (std::size_t d = 0; d < 3; ++d) {
    middle_[d] = 0.5 * (calibration.from_mm.at(d) + calibration.to_mm.at(d));
    half_[d] = 0.5 * (calibration.to_mm.at(d) - calibration.from_mm.at(d));
  }
  for (std::size_t k = 0; k < kSoloffTerms; ++k) {
    factors_[0][k] = calibration.object_x_mm.at(k);
    factors_[1][k] = calibration.object_y_mm.at(k);
    factors_[2][k] = calibration.object_z_mm.at(k);
  }
}

Point3 SoloffPolynomial::scaled(const Point3& at) const noexcept {
  return {(at[0] - middle_[0]) / half_[0], (at[1] - middle_[1]) / half_[1], (at[2] - middle_[2]) / half_[2]};
}

Point3 SoloffPolynomial::map(const Point3& at) const noexcept {
  const SoloffTerms terms = soloff_terms(scaled(at));
  return {sum(factors_[0], terms), sum(factors_[1], terms), sum(factors_[2], terms)};
}

Matrix3 SoloffPolynomial::jacobian(const Point3& at) const noexcept {
  Matrix3 jacobian{};
  for (std::size_t column = 0; column < 3; ++column) {
    const SoloffTerms slopes = soloff_slopes(scaled(at), column);
    for (std::size_t row = 0; row < 3; ++row) jacobian[row][column] = sum(factors_[row], slopes) / half_[column];
  }
  return jacobian;
}

Point3 SoloffPolynomial::inverse(const Point3& mapped) const noexcept {
  Point3 at = middle_;
  constexpr int kSteps = 30;
  for (int step = 0; step < kSteps; ++step) {
    const Point3 now = map(at);
    Point3 move{};
    if (!solve(jacobian(at), {mapped[0] - now[0], mapped[1] - now[1], mapped[2] - now[2]}, move)) break;
    double largest = 0;  // in half boxes; a longer step than one leaves the region where the slope says anything
    for (std::size_t d = 0; d < 3; ++d) largest = std::max(largest, std::abs(move[d]) / half_[d]);
    const double damping = largest > 1 ? 1 / largest : 1;
    for (std::size_t d = 0; d < 3; ++d) at[d] += damping * move[d];
    if (largest < 1e-13) break;
  }
  return at;
}

}  // namespace rptv
