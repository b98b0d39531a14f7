// SPDX-License-Identifier: MIT
// A grid over the volume, and the errors at each of its places.
#include "calibration/cameras/volume_accuracy.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "calibration/cameras/median.hpp"
#include "calibration/cameras/rig_accuracy.hpp"
#include "calibration/space_algebra.hpp"
#include "core/json.hpp"

namespace rptv {

namespace {

constexpr int kGrid = 11;

/// Of each place, mm; the square roots of variances along x, y, z.
using Errors = std::array<std::vector<double>, 3>;

ErrorSpread spread_of(const Errors& errors) {
  ErrorSpread spread;
  for (std::size_t axis = 0; axis < 3 && !errors[axis].empty(); ++axis) {
    spread.worst_mm[axis] = *std::max_element(errors[axis].begin(), errors[axis].end());
    spread.median_mm[axis] = median(errors[axis]);
  }
  return spread;
}

std::vector<std::size_t> seeing(const std::vector<CameraModel>& cameras, const Point3& point_mm) {
  std::vector<std::size_t> places;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    if (const auto at = cameras[c].project(point_mm); at && cameras[c].in_image(*at)) places.push_back(c);
  return places;
}

void find_box(const BoardSet& set, const Bundle& bundle, VolumeAccuracy& volume) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  volume.from_mm.fill(kInfinity), volume.to_mm.fill(-kInfinity);
  for (const auto& target : bundle.targets)
    for (std::size_t k = 0; target && k < set.target_mm.size(); ++k) {
      const Point3 p = target->rotation * set.target_mm[k] + target->translation_mm;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        volume.from_mm[axis] = std::min(volume.from_mm[axis], p[axis]);
        volume.to_mm[axis] = std::max(volume.to_mm[axis], p[axis]);
      }
    }
}

/// How all `points` move with the parameters, less what a shift and a turn of all of them together would do.
ErrorSpread shape_errors(const BundleCovariance& covariance, const std::vector<Point3>& points,
                         const std::vector<std::vector<double>>& derivatives) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto size = static_cast<Eigen::Index>(covariance.size()), count = static_cast<Eigen::Index>(points.size());
  Rows by_parameter(3 * count, size), by_motion(3 * count, 6);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [x, y, z] = points[static_cast<std::size_t>(i)];
    by_motion.middleRows<3>(3 * i) << 1, 0, 0, 0, z, -y, 0, 1, 0, -z, 0, x, 0, 0, 1, y, -x, 0;
    by_parameter.middleRows<3>(3 * i) =
        Eigen::Map<const Rows>(derivatives[static_cast<std::size_t>(i)].data(), 3, size);
  }
  by_parameter -= by_motion * Rows(by_motion.colPivHouseholderQr().solve(by_parameter));
  const Eigen::Map<const Rows> all(covariance.values.data(), size, size);
  const Eigen::VectorXd squares = (by_parameter * all).cwiseProduct(by_parameter).rowwise().sum();
  Errors errors;
  for (Eigen::Index row = 0; row < squares.size(); ++row)
    errors[static_cast<std::size_t>(row % 3)].push_back(std::sqrt(std::max(squares[row], 0.0)));
  return spread_of(errors);
}

std::string text_of(const ErrorSpread& s) {
  return fmt::format("median {:.4f} {:.4f} {:.4f} mm, worst {:.4f} {:.4f} {:.4f} mm", s.median_mm[0], s.median_mm[1],
                     s.median_mm[2], s.worst_mm[0], s.worst_mm[1], s.worst_mm[2]);
}

std::string json_of(const std::string& prefix, const std::optional<ErrorSpread>& spread) {
  if (!spread) return fmt::format("\"{0}median_mm\":null,\"{0}worst_mm\":null", prefix);
  return fmt::format("\"{0}median_mm\":{1},\"{0}worst_mm\":{2}", prefix, json_point(spread->median_mm),
                     json_point(spread->worst_mm));
}

}  // namespace

std::string json_point(const Point3& p) {
  return "[" + json_number(p[0]) + "," + json_number(p[1]) + "," + json_number(p[2]) + "]";
}

VolumeAccuracy volume_accuracy(const BoardSet& set, const BundleResult& result, double sigma_px) {
  VolumeAccuracy volume;
  find_box(set, result.bundle, volume);
  const auto models = models_of(result.bundle);
  Errors detection, calibration, together;
  std::vector<Point3> points;
  std::vector<std::vector<double>> derivatives;
  for (int i = 0; i < kGrid * kGrid * kGrid; ++i) {
    const std::array<int, 3> at{i % kGrid, i / kGrid % kGrid, i / kGrid / kGrid};
    Point3 p{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[axis] = volume.from_mm[axis] + (volume.to_mm[axis] - volume.from_mm[axis]) * at[axis] / (kGrid - 1);
    const auto error = expected_error_mm(models, p, sigma_px);
    if (!error) continue;
    const auto cameras = seeing(models, p);
    const auto square = calibration_covariance_mm2(result.covariance, cameras, p);
    if (square) points.push_back(p), derivatives.push_back(*point_by_parameters(result.covariance, cameras, p));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      detection[axis].push_back((*error)[axis]);
      if (!square) continue;
      calibration[axis].push_back(std::sqrt((*square)[axis][axis]));
      together[axis].push_back(std::hypot((*error)[axis], calibration[axis].back()));
    }
  }
  volume.seen = static_cast<double>(detection[0].size()) / (kGrid * kGrid * kGrid);
  volume.detection = spread_of(detection);
  if (points.empty()) return volume;
  volume.calibration = spread_of(calibration), volume.together = spread_of(together);
  volume.shape = shape_errors(result.covariance, points, derivatives);
  return volume;
}

std::string to_text(const VolumeAccuracy& v, double sigma_px) {
  std::string text = fmt::format(
      "expected          in x {:.0f} to {:.0f}, y {:.0f} to {:.0f}, z {:.0f} to {:.0f} mm, {:.0f} % of which two or "
      "more cameras see\n"
      "  by images       a particle placed to {} px: {}\n",
      v.from_mm[0], v.to_mm[0], v.from_mm[1], v.to_mm[1], v.from_mm[2], v.to_mm[2], 100 * v.seen, sigma_px,
      text_of(v.detection));
  if (!v.calibration)
    return text +
           "  by calibration  not known: these images do not determine all that was fitted; take more views, tilted to "
           "all sides and all over the sensors, or fit less\n";
  return text + fmt::format(
                    "  by calibration  all particles alike: {}\n"
                    "  of its shape    less what shifts and turns the whole volume: {}\n"
                    "  together        images and calibration: {}\n",
                    text_of(*v.calibration), text_of(*v.shape), text_of(*v.together));
}

std::string to_json(const VolumeAccuracy& v, double sigma_px) {
  return fmt::format("{{\"sigma_px\":{},{},{},{},{},\"from_mm\":{},\"to_mm\":{},\"seen\":{}}}", json_number(sigma_px),
                     json_of("", v.detection), json_of("calibration_", v.calibration), json_of("shape_", v.shape),
                     json_of("together_", v.together), json_point(v.from_mm), json_point(v.to_mm), json_number(v.seen));
}

}  // namespace rptv
