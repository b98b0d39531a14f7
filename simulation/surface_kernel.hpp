// SPDX-License-Identifier: MIT
// One ray at one surface: the arithmetic of the ray trace, without branches so that it runs on many rays at once.
#pragma once

#include <cmath>

namespace rptv {

/// A surface or rim as a ray meets it.
struct SurfaceStep {
  double z = 0;          ///< vertex, lens frame, mm
  double curvature = 0;  ///< 1/mm
  double conic = 0;
  double rim2 = 0;   ///< square of the clear radius; infinite without a rim
  double ratio = 1;  ///< refractive index before over behind, in the direction of travel
};

/// Moves a ray to the surface, on the sheet that holds the vertex: c (x^2 + y^2 + (1+k) z^2) = 2 z, and bends it there
/// by Snell's law, d' = r d + (r cos i - cos t) N (Welford 1986, chapter 4). False when the ray misses, hits the rim or
/// is totally reflected; the ray is then not a number or undefined.
[[gnu::always_inline]] inline bool pass_surface(const SurfaceStep& s, double& x, double& y, double& z, double& l,
                                                double& m, double& n) noexcept {
  const double depth = z - s.z, c = s.curvature, k1 = 1 + s.conic;
  const double a = c * (1 + s.conic * n * n);
  const double b = n - c * (x * l + y * m + k1 * depth * n);
  const double e = c * (x * x + y * y + k1 * depth * depth) - 2 * depth;
  const double meets = b * b - a * e;
  const double length = e / (b + std::copysign(std::sqrt(meets), n));
  x += length * l;
  y += length * m;
  z += length * n;
  const bool clear = x * x + y * y <= s.rim2;  // false as well when the ray misses
  double nx = c * x, ny = c * y, nz = c * k1 * (z - s.z) - 1;
  const double scale = 1 / std::sqrt(nx * nx + ny * ny + nz * nz);
  nx *= scale, ny *= scale, nz *= scale;
  const double cosine = -(l * nx + m * ny + n * nz);  // negative when the normal runs with the ray
  const double inside = 1 - s.ratio * s.ratio * (1 - cosine * cosine);
  const double along = s.ratio * cosine - std::copysign(std::sqrt(inside), cosine);
  l = s.ratio * l + along * nx;
  m = s.ratio * m + along * ny;
  n = s.ratio * n + along * nz;
  return clear & (inside >= 0);
}

}  // namespace rptv
