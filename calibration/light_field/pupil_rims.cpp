// SPDX-License-Identifier: MIT
// Levenberg-Marquardt over four numbers, from several starts.
#include "calibration/light_field/pupil_rims.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace rptv {

namespace {

constexpr std::size_t kBins = 24;         // of the distance from the axis
constexpr double kLeastSpots = 8;         // in a bin
constexpr double kLeastLight = 0.02;      // of those on the axis: less has no centroid
constexpr double kLeastCut = 0.05;        // of the light at the edge of the field: else there is no vignetting
constexpr int kStrips = 64, kSteps = 60;  // across the pupil; of a fit
constexpr double kMostMisfit = 5;         // rms, in sigmas: else it is something else
constexpr double kLightSigma = 0.01, kShiftSigma = 0.01;  // of a bin; the second over the pupil's radius

/// What is left of the pupil for a point of the array.
struct Opening {
  double light, shift;  // share; of the centroid, away from the axis, over the pupil's radius
};

struct Bin {
  double array_mm = 0, light = 0, shift = 0, spots = 0;
};

using Rims = Eigen::Vector4d;  // shift and first distance at which it cuts, mm, of either rim

PupilRim rim_of(const Rims& rims, int k, double pupil_mm) {
  return {rims[2 * k], pupil_mm + std::abs(rims[2 * k]) * rims[2 * k + 1]};
}

Opening opening(const Rims& rims, double array_mm, double pupil_mm) {
  double area = 0, moment = 0, whole = 0;
  for (int i = 0; i < kStrips; ++i) {
    const double t = (2.0 * i + 1) / kStrips - 1;
    double square = 1 - t * t;
    whole += std::sqrt(square);
    for (int k = 0; k < 2; ++k) {
      const PupilRim rim = rim_of(rims, k, pupil_mm);
      const double radius = rim.radius_mm / pupil_mm, from = t + rim.shift * array_mm / pupil_mm;
      square = std::min(square, radius * radius - from * from);
    }
    const double half = std::sqrt(std::max(square, 0.0));
    area += half, moment += t * half;
  }
  return {area / whole, area > 0 ? moment / area : 0};
}

std::vector<Bin> bins_of(const FoundLenslets& found, const LightFieldCalibration& c, double pupil_mm) {
  const auto axis = c.optical_axis_px();
  const double pixel_mm = c.pixel_mm(), width = found.field_radius_px / kBins;
  std::vector<Bin> bins(kBins);
  for (const auto& s : found.spots) {
    const double x = s.predicted_x_px - axis[0], y = s.predicted_y_px - axis[1], r = std::hypot(x, y);
    const auto bin = static_cast<std::size_t>(r / width);
    if (s.light < kLeastLight || (s.reason & lenslet_reason::kBorder) != 0 || bin >= kBins || !(r > 0)) continue;
    const double out_px = ((s.centroid_x_px - s.predicted_x_px) * x + (s.centroid_y_px - s.predicted_y_px) * y) / r;
    bins[bin].array_mm += r * pixel_mm / c.apparent_scale(), bins[bin].light += s.light;
    // A lenslet turns the pupil over.
    bins[bin].shift -= out_px * pixel_mm * c.lens.exit_pupil_mm / c.lenslets.focal_length_mm / pupil_mm;
    ++bins[bin].spots;
  }
  std::erase_if(bins, [](const Bin& b) { return b.spots < kLeastSpots; });
  for (auto& b : bins) b.array_mm /= b.spots, b.light /= b.spots, b.shift /= b.spots;
  return bins;
}

Eigen::VectorXd misfit(const std::vector<Bin>& bins, const Rims& rims, double pupil_mm) {
  Eigen::VectorXd rest(2 * static_cast<Eigen::Index>(bins.size()));
  for (Eigen::Index i = 0; i < rest.size() / 2; ++i) {
    const Bin& bin = bins[static_cast<std::size_t>(i)];
    const Opening open = opening(rims, bin.array_mm, pupil_mm);
    rest[2 * i] = (bin.light - open.light) / kLightSigma, rest[2 * i + 1] = (bin.shift - open.shift) / kShiftSigma;
  }
  return rest;
}

Rims climb(const std::vector<Bin>& bins, Rims rims, double pupil_mm) {
  Eigen::VectorXd rest = misfit(bins, rims, pupil_mm);
  double damping = 1e-2;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix<double, Eigen::Dynamic, 4> slope(rest.size(), 4);
    for (int k = 0; k < 4; ++k) {
      Rims moved = rims;
      const double by = 1e-3 * std::max(std::abs(rims[k]), 0.1);
      moved[k] += by;
      slope.col(k) = (rest - misfit(bins, moved, pupil_mm)) / by;
    }
    Eigen::Matrix4d normal = slope.transpose() * slope;
    normal.diagonal() *= 1 + damping;
    normal.diagonal().array() += 1e-9;
    const Rims next = rims + normal.ldlt().solve(slope.transpose() * rest);
    const Eigen::VectorXd left = misfit(bins, next, pupil_mm);
    const bool better = next.allFinite() && left.squaredNorm() < rest.squaredNorm();
    damping *= better ? 0.3 : 10;
    if (better) rims = next, rest = left;
  }
  return rims;
}

}  // namespace

std::vector<PupilRim> fit_pupil_rims(const FoundLenslets& found, const LightFieldCalibration& calibration) {
  const double exit_pupil_mm = calibration.lens.exit_pupil_mm;
  if (!(exit_pupil_mm > 0) || !(found.diameter_px > 0) || found.overlapping) return {};
  const double pupil_mm =
      calibration.lens.image_f_number > 0
          ? 0.5 * exit_pupil_mm / calibration.lens.image_f_number
          : 0.5 * found.diameter_px * calibration.pixel_mm() * exit_pupil_mm / calibration.lenslets.focal_length_mm;
  const std::vector<Bin> bins = bins_of(found, calibration, pupil_mm);
  if (bins.size() < 4 || bins.back().light > 1 - kLeastCut) return {};
  const double field_mm = bins.back().array_mm;
  Rims best = Rims::Zero();
  double least = misfit(bins, best, pupil_mm).squaredNorm();
  for (const double before : {0.4, 0.7, 1.2})  // the first cut, over the field
    for (const double behind : {0.4, 0.7, 1.2}) {
      const Rims rims = climb(bins, Rims(-0.3, before * field_mm, 0.3, behind * field_mm), pupil_mm);
      const double left = misfit(bins, rims, pupil_mm).squaredNorm();
      if (left < least) least = left, best = rims;
    }
  if (std::sqrt(least / (2.0 * static_cast<double>(bins.size()))) > kMostMisfit) return {};
  std::vector<PupilRim> rims;
  for (int k = 0; k < 2; ++k)
    if (best[2 * k] != 0 && best[2 * k + 1] > 0 && best[2 * k + 1] < field_mm)
      rims.push_back(rim_of(best, k, pupil_mm));
  return rims;
}

}  // namespace rptv
