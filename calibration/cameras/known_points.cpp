// SPDX-License-Identifier: MIT
// Levenberg-Marquardt over the pose and lens of one camera after the other.
#include "calibration/cameras/known_points.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "calibration/space_algebra.hpp"
#include "core/csv_reader.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"

namespace rptv {
namespace {

constexpr int kMostSteps = 60;
constexpr double kHuber = 1.5, kOutlier = 4;  // robust standard deviations
constexpr double kFinest = 1e-4;              // px: below, residuals are rounding
constexpr double kUndetermined = 1e-5;        // of the largest singular value, columns of unit length

std::vector<KnownPoint> read_all(CsvReader csv, const Rig& rig) {
  std::vector<KnownPoint> points;
  while (csv.next()) {
    KnownPoint point;
    const auto named = [&](const RigCamera& camera) { return camera.name == csv.text(0); };
    const auto found = std::find_if(rig.cameras.begin(), rig.cameras.end(), named);
    if (found == rig.cameras.end())
      csv.refuse(fmt::format("the rig has no camera {}; name those of the rig", in_quotes(csv.text(0))));
    point.camera = static_cast<std::size_t>(found - rig.cameras.begin());
    for (std::size_t k = 0; k < 3; ++k) point.position_mm[k] = csv.number(1 + k);
    point.pixel = {csv.number(4), csv.number(5)};
    points.push_back(point);
  }
  return points;
}

std::vector<CsvColumn> columns() { return {{"camera"}, {"x"}, {"y"}, {"z"}, {"column"}, {"row"}}; }

/// Projection less pixel of every point, column, row, column, …; none when a point cannot be seen.
std::optional<Eigen::VectorXd> misses(const CameraModel& model, const std::vector<KnownPoint>& points) {
  Eigen::VectorXd off(2 * static_cast<Eigen::Index>(points.size()));
  Eigen::Index row = 0;
  for (const KnownPoint& point : points) {
    const auto pixel = model.project(point.position_mm);
    if (!pixel) return {};
    off[row++] = (*pixel)[0] - point.pixel[0], off[row++] = (*pixel)[1] - point.pixel[1];
  }
  return off;
}

Eigen::ArrayXd lengths(const Eigen::VectorXd& off) {
  return off.reshaped(2, off.size() / 2).colwise().norm().transpose();
}

/// Standard deviation per axis by the median length, which for a Gaussian in two dimensions is 1.1774 of it.
double robust_sigma(const Eigen::VectorXd& off) {
  Eigen::ArrayXd sorted = lengths(off);
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  return std::max(kFinest, sorted[sorted.size() / 2] / 1.1774);
}

/// Square root of Huber's weight, twice per point.
Eigen::ArrayXd weights(const Eigen::VectorXd& off, double sigma) {
  const Eigen::ArrayXd each = (kHuber * sigma / lengths(off).max(1e-300)).min(1.0).sqrt();
  return each.transpose().replicate(2, 1).reshaped();
}

std::span<const double> numbers(const Eigen::VectorXd& v) { return {v.data(), static_cast<std::size_t>(v.size())}; }

Eigen::MatrixXd slopes(const CameraChange& change, const std::vector<KnownPoint>& points, Eigen::Index rows) {
  constexpr double kStep = 1e-3;
  const auto size = static_cast<Eigen::Index>(change.size());
  Eigen::MatrixXd by(rows, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(size, k), back = -step;
    const auto more = misses(change.changed(numbers(step)), points);
    const auto less = misses(change.changed(numbers(back)), points);
    by.col(k) = more && less ? Eigen::VectorXd((*more - *less) / (2 * kStep)) : Eigen::VectorXd::Zero(rows);
  }
  return by;
}

/// The camera with the least weighted squares, from `model` on. None when the points do not determine it.
std::optional<CameraModel> refined(CameraModel model, const std::vector<KnownPoint>& points, CameraFreedom allowed,
                                   double distance_mm) {
  Eigen::VectorXd off = *misses(model, points);
  double damping = 1e-3;
  for (int step = 0; step < kMostSteps; ++step) {
    const CameraChange freedom(allowed, model, distance_mm);
    const double sigma = robust_sigma(off);
    const Eigen::ArrayXd weight = weights(off, sigma);
    const Eigen::MatrixXd by = weight.matrix().asDiagonal() * slopes(freedom, points, off.size());
    const Eigen::VectorXd length = by.colwise().norm().cwiseMax(1e-300);
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(by * length.cwiseInverse().asDiagonal(),
                                                Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& s = svd.singularValues();
    if (!(s[s.size() - 1] > kUndetermined * s[0])) return {};
    const Eigen::VectorXd pull = svd.matrixU().transpose() * (-(weight * off.array()).matrix());
    const Eigen::VectorXd change =
        length.cwiseInverse().asDiagonal() *
        (svd.matrixV() * (s.array() / (s.array().square() + damping) * pull.array()).matrix());
    const CameraModel next = freedom.changed(numbers(change));
    const auto left = misses(next, points);
    const auto cost = [&](const Eigen::VectorXd& residual) {  // Huber's, at this step's scale
      const Eigen::ArrayXd r = lengths(residual) / (kHuber * sigma);
      return (r < 1).select(r.square(), 2 * r - 1).sum();
    };
    if (left && cost(*left) < cost(off)) {
      const bool done = change.norm() < 1e-7;
      model = next, off = *left, damping = std::max(1e-12, 0.1 * damping);
      if (done) break;
    } else if (damping > 1e6 || change.norm() < 1e-9) {
      break;
    } else {
      damping *= 10;
    }
  }
  return model;
}

double rms(const Eigen::VectorXd& off) {
  return std::sqrt(off.squaredNorm() / (0.5 * static_cast<double>(off.size())));
}

}  // namespace

std::vector<KnownPoint> read_known_points(const std::filesystem::path& file, const Rig& rig) {
  return read_all(CsvReader(file, columns()), rig);
}

std::vector<KnownPoint> parse_known_points(std::string_view text, const std::string& origin, const Rig& rig) {
  return read_all(CsvReader::from_text(text, origin, columns()), rig);
}

KnownPointsFit fit_known_points(const Rig& start, const std::vector<KnownPoint>& points, CameraFreedom freedom,
                                const std::string& origin) {
  KnownPointsFit fit{start, std::vector<KnownPointsCamera>(start.cameras.size())};
  for (std::size_t k = 0; k < start.cameras.size(); ++k) {
    std::vector<KnownPoint> mine;
    std::copy_if(points.begin(), points.end(), std::back_inserter(mine),
                 [&](const KnownPoint& p) { return p.camera == k; });
    if (mine.empty()) continue;
    CameraModel& model = fit.rig.cameras[k].model;
    KnownPointsCamera& report = fit.cameras[k];
    const auto refuse = [&](const std::string& text) {
      throw Error(ExitCode::bad_data, fmt::format("{}: camera {} {}", origin, in_quotes(start.cameras[k].name), text));
    };
    const double distance_mm = norm(mine.front().position_mm - model.centre_mm());
    const auto needed = CameraChange(freedom, model, distance_mm).size();
    const auto before = misses(model, mine);
    if (!before) refuse("cannot see all its points from where it starts; give a start that looks at them");
    for (int pass = 0; pass < 2; ++pass) {
      if (mine.size() < needed) refuse(fmt::format("has {} points left; give at least {}", mine.size(), needed));
      const auto better = refined(model, mine, freedom, distance_mm);
      if (!better) refuse("has points that do not determine it; take some at other depths, or fit less");
      model = *better;
      const Eigen::VectorXd off = *misses(model, mine);
      const double limit = kOutlier * robust_sigma(off);
      const Eigen::ArrayXd length = lengths(off);
      std::vector<KnownPoint> good;
      for (std::size_t i = 0; i < mine.size(); ++i)
        if (length[static_cast<Eigen::Index>(i)] <= limit) good.push_back(mine[i]);
      report.left_out += mine.size() - good.size();
      mine = std::move(good);
    }
    const Eigen::VectorXd off = *misses(model, mine);
    report.points = mine.size(), report.before_rms_px = rms(*misses(start.cameras[k].model, mine));
    report.rms_px = rms(off), report.worst_px = lengths(off).maxCoeff();
  }
  return fit;
}

}  // namespace rptv
