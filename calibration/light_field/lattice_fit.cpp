// SPDX-License-Identifier: MIT
// Reweighted least squares for a lattice: linear in all parameters once the place of the distortion's terms is known.
#include "calibration/light_field/lattice_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/cameras/median.hpp"

namespace rptv {

namespace {

constexpr int kPlain = 4, kBent = 20;  // offset, pitch·(cos, sin); and 2 linear, 6 quadratic, 8 cubic terms
constexpr double kTukey = 4.685;       // 95 % efficient for normal errors
constexpr double kToSigma = 1.4826;

/// Tukey's weight and loss of a residual in scatters.
double weight_of(double r) noexcept {
  const double s = 1 - (r / kTukey) * (r / kTukey);
  return std::abs(r) < kTukey ? s * s : 0;
}
double loss_of(double r) noexcept {
  const double s = std::abs(r) < kTukey ? 1 - (r / kTukey) * (r / kTukey) : 0;
  return kTukey * kTukey / 3 * (1 - s * s * s);
}

/// One equation pair: rows of the design matrix for x and y.
using Row = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kBent>;

Row row_of(const LatticeSpot& spot, const LensletGeometry& geometry, int parameters) {
  Row row = Row::Zero(2, parameters);
  const bool hexagonal = geometry.parameters().shape == "hexagonal";
  const double a = spot.u + (hexagonal ? 0.5 * spot.v : 0.0), b = spot.v * (hexagonal ? std::sqrt(0.75) : 1.0);
  row.leftCols<4>() << 1, 0, a, -b, 0, 1, b, a;
  if (parameters == kPlain) return row;
  const auto at = geometry.undistorted_mm(spot.u, spot.v);
  const double radius = geometry.parameters().radius_mm;
  const auto terms = distortion_terms(at[0] / radius, at[1] / radius);
  row(0, 4) = terms[0], row(1, 4) = -terms[1];  // the linear terms that are no similarity
  row(0, 5) = terms[1], row(1, 5) = terms[0];
  for (int k = 0; k < 7; ++k)
    row(0, 6 + k) = terms[static_cast<std::size_t>(2 + k)], row(1, 13 + k) = terms[static_cast<std::size_t>(2 + k)];
  return row;
}

LatticeParameters lattice_of(const Eigen::VectorXd& p, const LatticeParameters& start) {
  LatticeParameters lattice = start;
  lattice.offset_mm = {p[0], p[1]};
  lattice.pitch_mm = std::hypot(p[2], p[3]), lattice.rotation_rad = std::atan2(p[3], p[2]);
  lattice.distortion_x_mm.fill(0), lattice.distortion_y_mm.fill(0);
  if (p.size() == kPlain) return lattice;
  lattice.distortion_x_mm[0] = p[4], lattice.distortion_y_mm[1] = -p[4];
  lattice.distortion_x_mm[1] = lattice.distortion_y_mm[0] = p[5];
  for (int k = 0; k < 7; ++k) {
    lattice.distortion_x_mm[static_cast<std::size_t>(2 + k)] = p[6 + k];
    lattice.distortion_y_mm[static_cast<std::size_t>(2 + k)] = p[13 + k];
  }
  return lattice;
}

/// Distances of the spots from where the lattice puts them, mm: x and y of each.
std::vector<double> residuals_of(std::span<const LatticeSpot> spots, const LatticeParameters& lattice) {
  const LensletGeometry geometry(lattice);
  std::vector<double> residuals;
  residuals.reserve(2 * spots.size());
  for (const auto& spot : spots) {
    const auto at = geometry.position_mm(spot.u, spot.v);
    residuals.push_back(spot.x_mm - at[0]), residuals.push_back(spot.y_mm - at[1]);
  }
  return residuals;
}

double scatter_of(const std::vector<double>& residuals) {
  std::vector<double> sizes(residuals.size());
  std::transform(residuals.begin(), residuals.end(), sizes.begin(), [](double r) { return std::abs(r); });
  return std::max(kToSigma * median(sizes), 1e-9);
}

}  // namespace

LatticeFit fit_lattice(std::span<const LatticeSpot> spots, const LatticeParameters& start, bool with_distortion,
                       double scatter_mm) {
  const int n = with_distortion ? kBent : kPlain;
  LatticeFit fit{start, 0, 0, 0, 0, static_cast<std::size_t>(n)};
  if (spots.size() < static_cast<std::size_t>(with_distortion ? kBent : 3)) return fit;
  std::vector<double> residuals = residuals_of(spots, start);
  constexpr int kSteps = 12;
  for (int step = 0; step < kSteps; ++step) {
    const LensletGeometry geometry(fit.lattice);
    const double scale = scatter_mm > 0 ? scatter_mm : scatter_of(residuals);
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    std::size_t used = 0;
    for (std::size_t k = 0; k < spots.size(); ++k) {
      // The first steps only clip: far from the answer a redescending weight would throw everything away.
      const double distance = std::hypot(residuals[2 * k], residuals[2 * k + 1]) / scale;
      const double weight = step < 3 ? 1 / std::max(1.0, distance) : weight_of(distance);
      if (weight <= 0) continue;
      const Row row = row_of(spots[k], geometry, n);
      normal.noalias() += weight * row.transpose() * row;
      right.noalias() += weight * row.transpose() * Eigen::Vector2d(spots[k].x_mm, spots[k].y_mm);
      ++used;
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(normal);
    if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-14)) return fit;
    fit.lattice = lattice_of(factor.solve(right), start);
    residuals = residuals_of(spots, fit.lattice);
    fit.scatter_mm = scatter_of(residuals), fit.used = used;
    fit.pitch_sigma_mm = fit.scatter_mm * std::sqrt(factor.solve(Eigen::MatrixXd::Identity(n, n))(2, 2));
  }
  const double scale = scatter_mm > 0 ? scatter_mm : fit.scatter_mm;
  for (const double r : residuals) fit.cost += 2 * loss_of(r / scale);
  return fit;
}

LatticeFit fit_lattice_as_seen(std::span<const LatticeSpot> spots, const LatticeParameters& start, bool may_bend) {
  const LatticeFit plain = fit_lattice(spots, start, false);
  constexpr std::size_t kLeastToBend = 200;  // fewer share their errors too much to tell a bend from them
  if (!may_bend || plain.used < kLeastToBend) return plain;
  const LatticeFit bent = fit_lattice(spots, start, true);
  if (bent.used == 0) return plain;
  constexpr double kPerParameter = 6, kVisible = 0.2;
  const double straight = fit_lattice(spots, start, false, bent.scatter_mm).cost;
  const double shift = LensletGeometry(bent.lattice).largest_distortion_mm();
  const bool seen = straight - bent.cost > kPerParameter * (kBent - kPlain) && shift > kVisible * bent.scatter_mm;
  return seen ? bent : plain;
}

}  // namespace rptv
