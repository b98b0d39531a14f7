// SPDX-License-Identifier: MIT
// How much better one expectation of a noisy grey value is than another, in arithmetic that compilers turn into vector
// code. Host and device.
#pragma once

#include <cstdint>
#include <cstring>

#include "reconstruct/host_device.hpp"

namespace rptv {

/// log(x) for normal x > 0, absolute error below 3e-7 for x near 1: exponent and the series of atanh.
RPTV_HOST_DEVICE_INLINE float log_of_positive(float x) noexcept {
  std::int32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;  // the rest lies between 1/√2 and √2
  bits -= exponent * (1 << 23);
  float rest = 0;
  std::memcpy(&rest, &bits, sizeof rest);
  const float s = (rest - 1) / (rest + 1), q = s * s;
  return 2 * s * (1 + q * (1.0F / 3 + q * (1.0F / 5 + q * (1.0F / 7 + q * (1.0F / 9))))) +
         static_cast<float>(exponent) * 0.693147181F;
}

/// Twice the log-likelihood of `expected` over that of `without`, all as variances of a grey value: that of a dark
/// pixel plus the shot noise of the light that is seen, expected, or expected without a particle. Shot and read noise
/// together are taken for Poisson noise of the same variance (the shifted Poisson model of Snyder et al., J. Opt. Soc.
/// Am. A 12, 1995); in units of the squared variance per grey value. The derivative is that of least squares with
/// weights 1/expected, so it is what steps with such weights climb.
RPTV_HOST_DEVICE_INLINE float poisson_gain(float seen, float expected, float without) noexcept {
  return 2 * (seen * log_of_positive(expected / without) - (expected - without));
}

}  // namespace rptv
