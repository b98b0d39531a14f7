// SPDX-License-Identifier: MIT
// Triangulation by Gauss-Newton, and its covariance.
#include "calibration/cameras/rig_accuracy.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "calibration/cameras/eigen_space.hpp"
#include "calibration/space_algebra.hpp"

namespace rptv {

namespace {

using Vector = Eigen::Vector3d;
using Matrix = Eigen::Matrix3d;

constexpr int kMostSteps = 20;

std::optional<Point3> nearest_to_rays(std::span<const Sighting> sightings) {
  Matrix sum = Matrix::Zero();
  Vector right = Vector::Zero();
  for (const auto& s : sightings) {
    const SightRay ray = s.camera->ray(s.pixel);
    if (!ray.valid()) return std::nullopt;
    const Vector d = vector_of(ray.direction);
    const Matrix across = Matrix::Identity() - d * d.transpose();
    sum += across, right += across * vector_of(ray.origin_mm);
  }
  if (!(sum.determinant() > 1e-9)) return std::nullopt;
  return point_of(sum.inverse() * right);
}

/// Adds one camera's share of JᵀJ (1/mm²) and of Jᵀ·(seen - projected).
bool add_sighting(const Sighting& s, const Point3& point, Matrix& square, Vector& gradient) {
  PixelJacobian by_point;
  const auto at = s.camera->project(point, by_point);
  if (!at) return false;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const Vector row(by_point[axis][0], by_point[axis][1], by_point[axis][2]);
    square += row * row.transpose();
    gradient += (s.pixel[axis] - (*at)[axis]) * row;
  }
  return true;
}

}  // namespace

std::vector<CameraModel> models_of(const Bundle& bundle) {
  std::vector<CameraModel> models;
  for (std::size_t c = 0; c < bundle.cameras.size(); ++c)
    models.emplace_back(bundle.lenses[c], bundle.cameras[c], stack_of(bundle, c));
  return models;
}

std::optional<Point3> triangulate(std::span<const Sighting> sightings) {
  if (sightings.size() < 2) return std::nullopt;
  auto point = nearest_to_rays(sightings);
  for (int step = 0; point && step < kMostSteps; ++step) {
    Matrix square = Matrix::Zero();
    Vector gradient = Vector::Zero();
    for (const auto& s : sightings)
      if (!add_sighting(s, *point, square, gradient)) return std::nullopt;
    const Vector change = square.inverse() * gradient;
    if (!change.allFinite()) return std::nullopt;
    *point = *point + point_of(change);
    if (change.norm() < 1e-9) return point;
  }
  return std::nullopt;
}

std::optional<Point3> expected_error_mm(std::span<const CameraModel> cameras, const Point3& point_mm, double sigma_px) {
  Matrix square = Matrix::Zero();
  Vector gradient = Vector::Zero();
  int seen = 0;
  for (const auto& camera : cameras)
    if (const auto at = camera.project(point_mm); at && camera.in_image(*at))
      seen += add_sighting({&camera, *at}, point_mm, square, gradient) ? 1 : 0;
  if (seen < 2) return std::nullopt;
  const Matrix inverse = square.inverse();
  return Point3{sigma_px * std::sqrt(inverse(0, 0)), sigma_px * std::sqrt(inverse(1, 1)),
                sigma_px * std::sqrt(inverse(2, 2))};
}

TargetErrors target_errors(const BoardSet& set, const BundleResult& result) {
  const auto models = models_of(result.bundle);
  std::map<std::pair<std::size_t, std::size_t>, std::vector<Sighting>> points;  // by view and point
  for (const auto& r : result.residuals) {
    const BoardView& image = set.images[r.image];
    points[{image.view, r.seen.point}].push_back({&models[image.camera], r.seen.pixel});
  }
  TargetErrors errors;
  double sum = 0;
  for (const auto& [key, sightings] : points) {
    const auto found = triangulate(sightings);
    if (!found) continue;
    const CameraPose& target = *result.bundle.targets[key.first];
    const double error = norm(*found - (target.rotation * set.target_mm[key.second] + target.translation_mm));
    sum += error * error, ++errors.points;
    errors.largest_mm = std::max(errors.largest_mm, error);
  }
  if (errors.points > 0) errors.rms_mm = std::sqrt(sum / static_cast<double>(errors.points));
  return errors;
}

}  // namespace rptv
