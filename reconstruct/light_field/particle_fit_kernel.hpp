// SPDX-License-Identifier: MIT
// The steps of a fit, whoever gathers and sums the rays. Host and device.
#pragma once

#include <cmath>
#include <cstdint>

#include "reconstruct/light_field/fit_covariance_kernel.hpp"
#include "reconstruct/light_field/ray_gate_kernel.hpp"

namespace rptv {

struct FitOptions {
  RayGate gate;
  double start_margin_mm = 0;  ///< how far aside of the candidate the particle may be
  double start_depth_mm = 0;   ///< how far before or behind it
  double slope_variance = 0;   ///< see solve()
  double pitch_mm = 0;
  double min_support = 3;
};

/// What a fit is for: to find a place, or to end there, with residual and covariance.
enum class FitFor : std::uint8_t { place, result };

constexpr int kWideFitSteps = 2;  // with the candidate's uncertainty added to the gate
constexpr int kMostFitSteps = 10;
constexpr double kStillMm = 5e-4;  // a step smaller than this (along z: a hundred times) ends the iteration

/// Rays within this distance of the start are all that a fit looks at, mm.
RPTV_HOST_DEVICE inline double gather_reach_mm(const FitOptions& options, double slope_half_range, double z) noexcept {
  return options.gate.half_width_at(z) + 2 * options.start_margin_mm + slope_half_range * options.start_depth_mm;
}

/// Moves `at` to where the rays that are gathered in `near` lead: near.sum(point, half width) are RaySums within the
/// gate, near.keep(point, reach) drops those that are farther. False: they are too few, or give no depth.
template <class Near>
RPTV_HOST_DEVICE inline bool converge(Near& near, const FitOptions& options, ImagePoint& at) noexcept {
  for (int step = 0; step < kMostFitSteps; ++step) {
    const double margin = step < kWideFitSteps ? options.start_margin_mm : 0;
    if (step == kWideFitSteps)  // the point is almost there: rays far from it will not matter any more
      near.keep(at, options.gate.half_width_at(at.z) + options.start_margin_mm / 2);
    const RaySums sums = near.sum(at, options.gate.half_width_at(at.z) + margin);
    if (sums.w < options.min_support) return false;
    const RayFit to = solve(sums, options.slope_variance, at.z);
    if (to.slope_spread <= 0) return false;
    at = {at.x + to.dx, at.y + to.dy, at.z + to.dz};
    if (step >= kWideFitSteps && fabs(to.dx) + fabs(to.dy) < kStillMm && fabs(to.dz) < 100 * kStillMm) break;
  }
  return true;
}

/// A point with what led to it.
struct FittedPoint {
  ImagePoint at;
  double support = 0;  ///< rays inside the gate there; 0: too few, or they give no depth
  RaySums sums;
  RayFit step;
};

/// The step from `at` with the gathered rays inside the gate, and the support of the point that it leads to.
template <class Near>
RPTV_HOST_DEVICE inline FittedPoint last_step(Near& near, const FitOptions& options, const ImagePoint& at) noexcept {
  FittedPoint found;
  found.sums = near.sum(at, options.gate.half_width_at(at.z));
  if (found.sums.w < options.min_support) return found;
  found.step = solve(found.sums, options.slope_variance, at.z);
  if (found.step.slope_spread <= 0) return found;
  found.at = {at.x + found.step.dx, at.y + found.step.dy, at.z + found.step.dz};
  found.support = near.sum(found.at, options.gate.half_width_at(found.at.z)).w;
  return found;
}

/// Its covariance from the gathered rays, near.ray(0) … near.ray(size - 1), lenslet by lenslet.
template <class Near>
RPTV_HOST_DEVICE inline FitCovariance covariance_at(const Near& near, std::size_t size, const FitOptions& options,
                                                    const FittedPoint& found) noexcept {
  const double half_width_mm = options.gate.half_width_at(found.at.z);
  LensletScores scores;
  for (std::size_t i = 0; i < size; ++i) {
    const Ray ray = near.ray(i);
    const RayOffset r = offset_of(ray, found.at);
    if (options.gate.distance(r) <= half_width_mm) scores.add(ray, r);
  }
  scores.close();
  return covariance_of(found.sums, found.step, scores, options.pitch_mm * options.pitch_mm / 12);
}

}  // namespace rptv
