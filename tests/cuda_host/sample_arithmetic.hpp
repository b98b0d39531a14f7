// SPDX-License-Identifier: MIT
// A kernel of much arithmetic, of which host, executor and PTX must give the same bits.
#pragma once

#include "reconstruct/cuda_device.hpp"

namespace rptv::cuda_host::sample {

/// What `arithmetic` computes for one element; by the host's compiler it is the oracle of what the PTX of it gives.
struct Arithmetic {
  double real;
  float single;
  long long whole;
  unsigned bits;
};

__host__ __device__ inline Arithmetic arithmetic_of(double a, double b, int m, int n) {
  Arithmetic r{};
  const double root = sqrt(fabs(a)), quotient = a / b;
  r.real = fma(a, b, root) + floor(quotient) - ceil(b) + trunc(a) * copysign(0.5, b) + round(a);
  r.real += (a < b ? a : b) + (a >= b ? 1.0 : -2.0) + (a != a ? 8.0 : 0.0);
  const float f = static_cast<float>(a), g = static_cast<float>(b);
  r.single = f * g - f / (g * g + 1.0f) + sqrtf(fabsf(f)) + static_cast<float>(m) + fmaf(f, f, g);
  r.whole = static_cast<long long>(m) * n + m / (n | 1) - m % (n | 1) + (m >> 3) + static_cast<int>(f * 0.0001f);
  r.whole += (m < n ? m : n) - (static_cast<unsigned>(m) > static_cast<unsigned>(n) ? 5 : 7);
  r.whole +=
      static_cast<long long>(static_cast<short>(m)) * static_cast<signed char>(n) + static_cast<unsigned char>(m);
  r.bits = (static_cast<unsigned>(m) << 5 ^ static_cast<unsigned>(n) >> 7) & ~static_cast<unsigned>(m | n);
  r.bits += static_cast<unsigned>((static_cast<unsigned long long>(m) * 0x9e3779b97f4a7c15ull) >> 40);
  r.bits /= static_cast<unsigned>(n & 63) + 1u;
  return r;
}

__global__ void arithmetic(const double* a, const double* b, const int* m, const int* n, unsigned count,
                           Arithmetic* results) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) results[i] = arithmetic_of(a[i], b[i], m[i], n[i]);
}

}  // namespace rptv::cuda_host::sample
