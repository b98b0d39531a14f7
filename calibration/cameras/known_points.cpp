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

Matrix3 turned(const Matrix3& rotation, double x, double y, double z) {
  const Eigen::Vector3d turn(x, y, z);
  const double angle = turn.norm();
  if (angle == 0) return rotation;
  const Eigen::Matrix3d by = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  const Matrix3 m{{{by(0, 0), by(0, 1), by(0, 2)}, {by(1, 0), by(1, 1), by(1, 2)}, {by(2, 0), by(2, 1), by(2, 2)}}};
  return m * rotation;
}

/// One camera's free numbers, as changes of a model, scaled so that 1 moves projections by about a pixel.
class Freedom {
 public:
  Freedom(KnownPointsFreedom freedom, const CameraModel& model, double distance_mm) : model_(model) {
    const auto& lens = model.intrinsics();
    const double px = 1 / lens.fx_px, radius = 0.5 * std::hypot(lens.width_px, lens.height_px) * px;
    scale_ = {px, px, px / radius, px * distance_mm, px * distance_mm, px / radius * distance_mm};
    if (freedom != KnownPointsFreedom::pose) scale_.push_back(px / radius);
    if (freedom == KnownPointsFreedom::distortion)
      scale_.insert(scale_.end(), {px / std::pow(radius, 3), px / (radius * radius), px / (radius * radius)});
  }

  Eigen::Index size() const { return static_cast<Eigen::Index>(scale_.size()); }

  CameraModel changed(const Eigen::VectorXd& by) const {
    const auto at = [&](std::size_t k) { return scale_[k] * by[static_cast<Eigen::Index>(k)]; };
    CameraIntrinsics lens = model_.intrinsics();
    CameraPose pose{turned(model_.pose().rotation, at(0), at(1), at(2)),
                    model_.pose().translation_mm + Point3{at(3), at(4), at(5)}};
    if (scale_.size() > 6) lens.fx_px *= 1 + at(6), lens.fy_px *= 1 + at(6);
    if (scale_.size() > 7) lens.k1 += at(7), lens.p1 += at(8), lens.p2 += at(9);
    return CameraModel(lens, pose, model_.stack());
  }

 private:
  const CameraModel& model_;
  std::vector<double> scale_;
};

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

Eigen::MatrixXd slopes(const Freedom& freedom, const std::vector<KnownPoint>& points, Eigen::Index rows) {
  constexpr double kStep = 1e-3;
  Eigen::MatrixXd by(rows, freedom.size());
  for (Eigen::Index k = 0; k < freedom.size(); ++k) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(freedom.size(), k);
    const auto more = misses(freedom.changed(step), points), less = misses(freedom.changed(-step), points);
    by.col(k) = more && less ? Eigen::VectorXd((*more - *less) / (2 * kStep)) : Eigen::VectorXd::Zero(rows);
  }
  return by;
}

/// The camera with the least weighted squares, from `model` on. None when the points do not determine it.
std::optional<CameraModel> refined(CameraModel model, const std::vector<KnownPoint>& points, KnownPointsFreedom allowed,
                                   double distance_mm) {
  Eigen::VectorXd off = *misses(model, points);
  double damping = 1e-3;
  for (int step = 0; step < kMostSteps; ++step) {
    const Freedom freedom(allowed, model, distance_mm);
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
    const CameraModel next = freedom.changed(change);
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

KnownPointsFit fit_known_points(const Rig& start, const std::vector<KnownPoint>& points, KnownPointsFreedom freedom,
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
    const auto needed = static_cast<std::size_t>(Freedom(freedom, model, distance_mm).size());
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
