// SPDX-License-Identifier: MIT
// From the covariance of all cameras to that of a point, to first order.
#include "calibration/cameras/bundle_covariance.hpp"

#include <Eigen/LU>

#include "calibration/cameras/eigen_space.hpp"

namespace rptv {

namespace {

using Rows = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor>;

std::optional<Rows> derivatives_of(const BundleCovariance& c, std::span<const std::size_t> cameras,
                                   const Point3& point_mm) {
  const auto at = [](std::size_t place) { return static_cast<Eigen::Index>(place); };
  const Eigen::Matrix3d turn = matrix_of(pose_of(c.frame).rotation);
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();
  Rows sum = Rows::Zero(3, at(c.size()));
  for (const std::size_t k : cameras) {
    const bool own = c.walls.has_window(k);
    static constexpr StackParameters kHeld{};
    const BundleProjection projection{
        c.lenses[k],           c.cameras[k],      c.frame, own ? &c.walls.windows[k] : &c.walls.stack,
        own ? kHeld : c.stack, &c.distortions[k], own};
    ProjectionDerivatives d;
    Pixel pixel;
    if (!projection.project(point_mm, pixel, &d)) return std::nullopt;
    const auto block = [](auto& values) {
      constexpr int kColumns = static_cast<int>(std::tuple_size_v<std::remove_cvref_t<decltype(values)>>) / 2;
      return Eigen::Map<const Eigen::Matrix<double, 2, kColumns, Eigen::RowMajor>>(values.data());
    };
    const Eigen::Matrix<double, 2, 3> by_point = block(d.by_target).template rightCols<3>() * turn;
    square += by_point.transpose() * by_point;
    sum.middleCols<9>(at(9 * k)) += by_point.transpose() * block(d.by_lens);
    sum.middleCols<6>(at(c.pose_at(k))) += by_point.transpose() * block(d.by_camera);
    if (!own) sum.middleCols<3>(at(c.stack_at())) += by_point.transpose() * block(d.by_stack);
    sum.middleCols<6>(at(c.frame_at())) += by_point.transpose() * block(d.by_target);
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> normal(square);
  if (cameras.size() < 2 || !normal.isInvertible()) return std::nullopt;
  return Rows(-normal.solve(sum));
}

}  // namespace

std::optional<std::vector<double>> point_by_parameters(const BundleCovariance& covariance,
                                                       std::span<const std::size_t> cameras, const Point3& point_mm) {
  const auto rows = derivatives_of(covariance, cameras, point_mm);
  if (!rows) return std::nullopt;
  return std::vector<double>(rows->data(), rows->data() + rows->size());
}

std::optional<Matrix3> calibration_covariance_mm2(const BundleCovariance& covariance,
                                                  std::span<const std::size_t> cameras, const Point3& point_mm) {
  if (covariance.values.empty()) return std::nullopt;
  const auto rows = derivatives_of(covariance, cameras, point_mm);
  if (!rows) return std::nullopt;
  const Eigen::Map<const Eigen::MatrixXd> all(covariance.values.data(), rows->cols(), rows->cols());
  return matrix3_of(Eigen::Matrix3d(*rows * all * rows->transpose()));
}

}  // namespace rptv
