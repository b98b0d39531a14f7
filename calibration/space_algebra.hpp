// SPDX-License-Identifier: MIT
// The few operations on points and matrices that cameras need, written out so that no header needs a matrix library.
#pragma once

#include <cmath>

#include "calibration/space.hpp"

namespace rptv {

constexpr double dot(const Point3& a, const Point3& b) noexcept { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline double norm(const Point3& a) noexcept { return std::sqrt(dot(a, a)); }

constexpr Point3 operator+(const Point3& a, const Point3& b) noexcept {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

constexpr Point3 operator-(const Point3& a, const Point3& b) noexcept {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

constexpr Point3 operator*(double factor, const Point3& a) noexcept {
  return {factor * a[0], factor * a[1], factor * a[2]};
}

constexpr Point3 cross(const Point3& a, const Point3& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

constexpr Point3 operator*(const Matrix3& m, const Point3& a) noexcept {
  return {dot(m[0], a), dot(m[1], a), dot(m[2], a)};
}

constexpr Matrix3 transpose(const Matrix3& m) noexcept {
  return {{{m[0][0], m[1][0], m[2][0]}, {m[0][1], m[1][1], m[2][1]}, {m[0][2], m[1][2], m[2][2]}}};
}

constexpr Matrix3 operator*(const Matrix3& a, const Matrix3& b) noexcept {
  const Matrix3 columns = transpose(b);
  return {{columns * a[0], columns * a[1], columns * a[2]}};
}

constexpr double determinant(const Matrix3& m) noexcept { return dot(m[0], cross(m[1], m[2])); }

/// Of a regular matrix; columns are cross products of rows over the determinant.
constexpr Matrix3 inverse(const Matrix3& m) noexcept {
  const double scale = 1 / determinant(m);
  return transpose({{scale * cross(m[1], m[2]), scale * cross(m[2], m[0]), scale * cross(m[0], m[1])}});
}

}  // namespace rptv
