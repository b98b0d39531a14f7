// SPDX-License-Identifier: MIT
// Least squares for the Soloff polynomial, with the residuals that points left out would have.
#include "calibration/light_field/fit_volume.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace rptv {

namespace {

constexpr std::size_t kLeastPairs = 25;
constexpr double kMostCondition = 200;

std::vector<double>& factors_of(PolynomialCalibration& p, int axis) {
  return axis == 0 ? p.object_x_mm : axis == 1 ? p.object_y_mm : p.object_z_mm;
}

void set_box(PolynomialCalibration& p, std::span<const Point3> points, const std::string& origin) {
  p.from_mm = p.to_mm = {points[0].begin(), points[0].end()};
  for (const auto& point : points)
    for (std::size_t k = 0; k < 3; ++k) {
      p.from_mm[k] = std::min(p.from_mm[k], point[k]);
      p.to_mm[k] = std::max(p.to_mm[k], point[k]);
    }
  for (std::size_t k = 0; k < 3; ++k)
    if (!(p.to_mm[k] - p.from_mm[k] > 1e-6))
      throw Error(ExitCode::bad_data, fmt::format("{}: all points have the same image_{}; move the target through the "
                                                  "volume: at least 3 depths, and 4 columns and rows in each",
                                                  origin, "xyz"[k]));
}

}  // namespace

VolumeResiduals residuals_of(const ObjectMap& map, std::span<const Correspondence> pairs) {
  VolumeResiduals r;
  const auto n = static_cast<double>(std::max<std::size_t>(pairs.size(), 1));
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Point3 at = map.to_object(pairs[i].image);
    double square = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double e = at[k] - pairs[i].object[k];
      r.rms[k] += e * e / n, square += e * e;
    }
    r.mean += std::sqrt(square) / n;
    if (std::sqrt(square) > r.largest) r.largest = std::sqrt(square), r.worst = i;
  }
  for (double& value : r.rms) value = std::sqrt(value);
  return r;
}

VolumeFit fit_volume(std::span<const Correspondence> pairs, const LightFieldCalibration& start,
                     const std::string& origin) {
  if (pairs.size() < kLeastPairs)
    throw Error(ExitCode::bad_data,
                fmt::format("{}: has {} points and a polynomial of {} factors needs at least {}; take "
                            "more positions of the target",
                            origin, pairs.size(), kSoloffTerms, kLeastPairs));
  VolumeFit fit;
  fit.calibration = start;
  auto& p = fit.calibration.polynomial;
  p = {};
  p.base = start.base_model();
  fit.calibration.lens.model = p.base;
  const ObjectMap lens(fit.calibration);  // what there is without the polynomial
  fit.calibration.lens.model = "polynomial";
  std::vector<Point3> points;
  for (const auto& pair : pairs) {
    if (!(pair.image[2] < lens.highest_z_mm()))
      throw Error(ExitCode::bad_data,
                  fmt::format("{}: a point has image_z = {:.6g} mm and the lens forms images only up "
                              "to {:.6g} mm; z counts towards the main lens",
                              origin, pair.image[2], lens.highest_z_mm()));
    points.push_back(lens.to_object(pair.image));
  }
  set_box(p, points, origin);
  const auto n = static_cast<Eigen::Index>(pairs.size());
  Eigen::MatrixXd terms(n, kSoloffTerms), object(n, 3);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& pair = pairs[static_cast<std::size_t>(i)];
    const Point3& at = points[static_cast<std::size_t>(i)];
    Point3 scaled{};
    for (std::size_t k = 0; k < 3; ++k)
      scaled[k] = (2 * at[k] - p.from_mm[k] - p.to_mm[k]) / (p.to_mm[k] - p.from_mm[k]);
    const SoloffTerms row = soloff_terms(scaled);
    for (std::size_t k = 0; k < kSoloffTerms; ++k) terms(i, static_cast<Eigen::Index>(k)) = row[k];
    for (int k = 0; k < 3; ++k) object(i, k) = pair.object[static_cast<std::size_t>(k)];
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(terms, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const auto& singular = svd.singularValues();
  fit.condition = singular[0] / std::max(singular[kSoloffTerms - 1], 1e-300);
  if (!(fit.condition < kMostCondition))
    throw Error(ExitCode::bad_data,
                fmt::format("{}: {} points do not fix the polynomial (condition {:.2g}, at most {:.0f}): "
                            "they lie on too few planes, rows or columns; use at least 3 depths, and 4 "
                            "columns and rows in each",
                            origin, pairs.size(), fit.condition, kMostCondition));
  const Eigen::MatrixXd factors = svd.solve(object);
  for (int axis = 0; axis < 3; ++axis) {
    auto& mine = factors_of(p, axis);
    mine.assign(factors.col(axis).begin(), factors.col(axis).end());
  }
  const Eigen::MatrixXd errors = terms * factors - object;
  const Eigen::VectorXd leverage = svd.matrixU().rowwise().squaredNorm();
  for (int axis = 0; axis < 3; ++axis)
    fit.left_out_rms[static_cast<std::size_t>(axis)] =
        std::sqrt((errors.col(axis).array() / (1 - leverage.array()).max(1e-6)).square().mean());
  fit.residuals = residuals_of(ObjectMap(fit.calibration), pairs);
  return fit;
}

}  // namespace rptv
