// SPDX-License-Identifier: MIT
// A blurred edge and its slope, in arithmetic that compilers turn into vector code. Host and device.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "reconstruct/host_device.hpp"

namespace rptv {

/// exp(x) for x ≤ 0, relative error below 2e-7; exp(-87) below -87. Cody-Waite reduction and a polynomial of degree 6.
RPTV_HOST_DEVICE_INLINE float exp_of_negative(float x) noexcept {
  const float inside = x > -87.0F ? x : -87.0F;
  const float whole = static_cast<float>(static_cast<std::int32_t>(inside * 1.44269504F - 0.5F));  // rounds: x <= 0
  const float rest = (inside - whole * 0.693359375F) + whole * 2.12194440e-4F;
  float p = 1.0F / 720;
  p = p * rest + 1.0F / 120;
  p = p * rest + 1.0F / 24;
  p = p * rest + 1.0F / 6;
  p = p * rest + 0.5F;
  p = p * rest + 1.0F;
  p = p * rest + 1.0F;
  const std::int32_t bits = (static_cast<std::int32_t>(whole) + 127) << 23;
  float power = 0;
  std::memcpy(&power, &bits, sizeof power);
  return p * power;
}

/// Light behind a straight edge that is blurred by a Gaussian: `share` = (1 + erf(t))/2 with t = distance/(σ√2), and
/// `bell` = exp(-t²)/√π = d share/dt. Absolute error of `share` below 1.5e-7 (Abramowitz and Stegun 7.1.26).
struct GaussEdge {
  float share, bell;
};

RPTV_HOST_DEVICE_INLINE GaussEdge gauss_edge(float t) noexcept {
  const float at = fabsf(t);
  const float e = exp_of_negative(-at * at);
  const float k = 1.0F / (1.0F + 0.3275911F * at);
  const float tail =
      0.5F * k * (0.254829592F + k * (-0.284496736F + k * (1.421413741F + k * (-1.453152027F + k * 1.061405429F)))) * e;
  return {t < 0 ? tail : 1.0F - tail, e * 0.564189584F};
}

/// The same behind an edge that is blurred by a kernel of another shape: `flatness` is its excess kurtosis over 24 (0:
/// Gaussian; a uniform disc, projected: -1/24). Gram-Charlier series to the fourth moment.
RPTV_HOST_DEVICE_INLINE GaussEdge blurred_edge(float t, float flatness) noexcept {
  const GaussEdge g = gauss_edge(t);
  const float square = 2 * t * t;  // in standard deviations
  return {g.share - flatness * t * (square - 3) * g.bell, g.bell * (1 + flatness * (square * (square - 6) + 3))};
}

}  // namespace rptv
