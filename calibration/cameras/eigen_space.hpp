// SPDX-License-Identifier: MIT
// Points and matrices as Eigen has them and back; for the few sources of calibration/ that solve systems with it.
#pragma once

#include <Eigen/Core>

#include "calibration/space.hpp"

namespace rptv {

inline Eigen::Vector3d vector_of(const Point3& p) { return {p[0], p[1], p[2]}; }
inline Point3 point_of(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

inline Eigen::Matrix3d matrix_of(const Matrix3& m) {
  Eigen::Matrix3d matrix;
  for (std::size_t row = 0; row < 3; ++row) matrix.row(static_cast<Eigen::Index>(row)) = vector_of(m[row]).transpose();
  return matrix;
}

inline Matrix3 matrix3_of(const Eigen::Matrix3d& m) {
  return {point_of(m.row(0).transpose()), point_of(m.row(1).transpose()), point_of(m.row(2).transpose())};
}

}  // namespace rptv
