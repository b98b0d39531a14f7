// SPDX-License-Identifier: MIT
// How sure a point fitted to rays is, when errors are shared within a lenslet. Host and device.
#pragma once

#include "reconstruct/light_field/n_ray_fit_kernel.hpp"

namespace rptv {

/// Covariance of a fitted point, mm²: xx, xy, xz, yy, yz, zz.
struct FitCovariance {
  double xx, xy, xz, yy, yz, zz;
};

/// What the rays of each lenslet together pull at the point: their errors are not independent, since the position in a
/// cell is a function of the slope. Rays are given lenslet by lenslet.
struct LensletScores {
  double x = 0, y = 0, z = 0;  ///< pull of the lenslet that is being summed
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  double lenslets = 0;
  float centre_x = 0, centre_y = 0;
  bool open = false;

  RPTV_HOST_DEVICE void close() noexcept {
    if (!open) return;
    xx += x * x, xy += x * y, xz += x * z, yy += y * y, yz += y * z, zz += z * z;
    x = y = z = 0;
    ++lenslets;
    open = false;
  }
  RPTV_HOST_DEVICE void add(const Ray& ray, const RayOffset& r) noexcept {
    if (open && (ray.centre_x != centre_x || ray.centre_y != centre_y)) close();
    centre_x = ray.centre_x, centre_y = ray.centre_y, open = true;
    x += r.x, y += r.y, z -= r.x * ray.slope_x + r.y * ray.slope_y;
  }
};

/// Covariance A⁻¹·B·A⁻¹ with the normal matrix A and B = Σ over lenslets of (pull)·(pull)ᵀ (errors independent between
/// lenslets, not within one; "sandwich"), plus what a few lenslets cannot show: the position is quantised by the pitch
/// (`cell_variance` = pitch²/12 along each axis), averaged over the lenslets laterally and over the rays in depth.
RPTV_HOST_DEVICE inline FitCovariance covariance_of(const RaySums& sums, const RayFit& fit, const LensletScores& b,
                                                    double cell_variance) noexcept {
  const double mean_x = sums.ws_x / sums.w, mean_y = sums.ws_y / sums.w;
  // Pulls with the mean slope taken out: A is diagonal there, (w, w, slope_spread).
  const double uz = b.xz + mean_x * b.xx + mean_y * b.xy, vz = b.yz + mean_x * b.xy + mean_y * b.yy;
  const double tz = b.zz + 2 * (mean_x * b.xz + mean_y * b.yz) + mean_x * mean_x * b.xx + 2 * mean_x * mean_y * b.xy +
                    mean_y * mean_y * b.yy;
  const double w = sums.w, spread = fit.slope_spread;
  const double lateral = cell_variance / (b.lenslets > 1 ? b.lenslets : 1);
  const double zz = tz / (spread * spread) + cell_variance / spread;
  const double xz = uz / (w * spread), yz = vz / (w * spread);
  const double xx = b.xx / (w * w) + lateral, yy = b.yy / (w * w) + lateral, xy = b.xy / (w * w);
  // Back: x = u + mean_x·z.
  return {xx + 2 * mean_x * xz + mean_x * mean_x * zz,
          xy + mean_x * yz + mean_y * xz + mean_x * mean_y * zz,
          xz + mean_x * zz,
          yy + 2 * mean_y * yz + mean_y * mean_y * zz,
          yz + mean_y * zz,
          zz};
}

}  // namespace rptv
