// SPDX-License-Identifier: MIT
// The point nearest to N rays: sums, the symmetric 3×3 system, residual and covariance. Host and device.
#pragma once

#include <cmath>

#include "reconstruct/host_device.hpp"
#include "reconstruct/light_field/ray.hpp"

namespace rptv {

/// A point of image space, mm.
struct ImagePoint {
  double x = 0, y = 0, z = 0;
};

/// Lateral distance at the point's depth from the point to a ray, mm.
struct RayOffset {
  double x, y;
};

RPTV_HOST_DEVICE inline RayOffset offset_of(const Ray& ray, const ImagePoint& point) noexcept {
  return {ray.centre_x + ray.slope_x * point.z - point.x, ray.centre_y + ray.slope_y * point.z - point.y};
}

/// Sums over rays c + s·z of weight w, with r their offsets from a point near the solution (so that nothing cancels).
struct RaySums {
  double w = 0, ws_x = 0, ws_y = 0, wss = 0;    ///< wss: w·(s_x² + s_y²)
  double wr_x = 0, wr_y = 0, wrs = 0, wrr = 0;  ///< wrs: w·(r_x·s_x + r_y·s_y); wrr: w·(r_x² + r_y²)

  RPTV_HOST_DEVICE void add(const Ray& ray, const RayOffset& r, double weight) noexcept {
    const double s_x = ray.slope_x, s_y = ray.slope_y;
    w += weight, ws_x += weight * s_x, ws_y += weight * s_y;
    wss += weight * (s_x * s_x + s_y * s_y);
    wr_x += weight * r.x, wr_y += weight * r.y;
    wrs += weight * (r.x * s_x + r.y * s_y);
    wrr += weight * (r.x * r.x + r.y * r.y);
  }
};

/// Step from the point that the offsets refer to, to the least-squares point.
struct RayFit {
  double dx = 0, dy = 0, dz = 0;
  double slope_spread = 0;  ///< Σ w·|s - mean s|²: the normal matrix's Schur complement for z; 0 means no depth
  double wrr = 0;           ///< Σ w·|r|² at the solution
};

/// Minimises Σ w·|r + s·dz - (dx, dy)|²: position regressed on slope. The 3×3 system
///   [ w     0    -ws_x ] [dx]   [ wr_x ]
///   [ 0     w    -ws_y ] [dy] = [ wr_y ]
///   [-ws_x -ws_y  wss  ] [dz]   [-wrs  ]
/// is solved by elimination of dx and dy. `slope_variance` (per axis) is what blur adds to the spread of the slopes; it
/// would shrink depths and is taken out of the sums, which were made at depth `z` (errors in variables; 0: exact
/// slopes).
RPTV_HOST_DEVICE inline RayFit solve(const RaySums& sums, double slope_variance, double z) noexcept {
  RayFit fit;
  if (!(sums.w > 0)) return fit;
  const double spread = sums.wss - (sums.ws_x * sums.ws_x + sums.ws_y * sums.ws_y) / sums.w;
  const double blur = 2 * sums.w * slope_variance;
  const double trend = sums.wrs - (sums.wr_x * sums.ws_x + sums.wr_y * sums.ws_y) / sums.w - blur * z;
  const double corrected = spread - blur;
  // Below this the rays are parallel to rounding (float slopes): the depth stays what it was.
  const bool deep = corrected > 1e-9 * sums.wss && corrected > 0.05 * spread;
  fit.slope_spread = deep ? corrected : 0;
  fit.dz = deep ? -trend / corrected : 0;
  fit.dx = (sums.wr_x + sums.ws_x * fit.dz) / sums.w;
  fit.dy = (sums.wr_y + sums.ws_y * fit.dz) / sums.w;
  const double square =
      sums.wrr + 2 * fit.dz * sums.wrs + fit.dz * fit.dz * sums.wss - sums.w * (fit.dx * fit.dx + fit.dy * fit.dy);
  fit.wrr = square > 0 ? square : 0;
  return fit;
}

}  // namespace rptv
