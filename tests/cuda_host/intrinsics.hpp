// SPDX-License-Identifier: MIT
// CUDA's bit operations, minima, rounding and reinterpretation. Approximate mathematics (rsqrtf, __expf, …) is left out
// on purpose: its bits differ between devices.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>

inline int __popc(unsigned x) { return __builtin_popcount(x); }
inline int __popcll(unsigned long long x) { return __builtin_popcountll(x); }
inline int __clz(int x) { return x == 0 ? 32 : __builtin_clz(static_cast<unsigned>(x)); }
inline int __clzll(long long x) { return x == 0 ? 64 : __builtin_clzll(static_cast<unsigned long long>(x)); }
inline int __ffs(int x) { return __builtin_ffs(x); }
inline int __ffsll(long long x) { return __builtin_ffsll(x); }
inline unsigned __umulhi(unsigned a, unsigned b) {
  return static_cast<unsigned>((static_cast<unsigned long long>(a) * b) >> 32);
}
inline unsigned __brev(unsigned x) {
  unsigned reversed = 0;
  for (int bit = 0; bit < 32; ++bit, x >>= 1) reversed = (reversed << 1) | (x & 1u);
  return reversed;
}

template <class T>
T __ldg(const T* address) {
  return *address;
}

inline int min(int a, int b) { return b < a ? b : a; }
inline int max(int a, int b) { return a < b ? b : a; }
inline unsigned min(unsigned a, unsigned b) { return b < a ? b : a; }
inline unsigned max(unsigned a, unsigned b) { return a < b ? b : a; }
inline long long min(long long a, long long b) { return b < a ? b : a; }
inline long long max(long long a, long long b) { return a < b ? b : a; }
inline unsigned long long min(unsigned long long a, unsigned long long b) { return b < a ? b : a; }
inline unsigned long long max(unsigned long long a, unsigned long long b) { return a < b ? b : a; }
inline long min(long a, long b) { return b < a ? b : a; }
inline long max(long a, long b) { return a < b ? b : a; }
inline unsigned long min(unsigned long a, unsigned long b) { return b < a ? b : a; }
inline unsigned long max(unsigned long a, unsigned long b) { return a < b ? b : a; }
inline float min(float a, float b) { return fminf(a, b); }
inline float max(float a, float b) { return fmaxf(a, b); }
inline double min(double a, double b) { return fmin(a, b); }
inline double max(double a, double b) { return fmax(a, b); }

inline float __fadd_rn(float a, float b) { return a + b; }
inline float __fsub_rn(float a, float b) { return a - b; }
inline float __fmul_rn(float a, float b) { return a * b; }
inline float __fdiv_rn(float a, float b) { return a / b; }
inline float __fsqrt_rn(float a) { return sqrtf(a); }
inline float __fmaf_rn(float a, float b, float c) { return fmaf(a, b, c); }
inline double __dadd_rn(double a, double b) { return a + b; }
inline double __dmul_rn(double a, double b) { return a * b; }
inline double __fma_rn(double a, double b, double c) { return fma(a, b, c); }

namespace rptv::cuda_host {

template <class To, class From>
To bits_as(From from) {
  static_assert(sizeof(To) == sizeof(From), "the same size");
  To to;
  std::memcpy(&to, &from, sizeof(To));
  return to;
}

/// As the device converts: what does not fit becomes the nearest int, not-a-number becomes 0. `rounded` is a whole
/// number.
inline int saturated_int(float rounded) {
  if (std::isnan(rounded)) return 0;
  if (rounded >= 2147483648.0f) return std::numeric_limits<int>::max();
  return rounded < -2147483648.0f ? std::numeric_limits<int>::min() : static_cast<int>(rounded);
}

}  // namespace rptv::cuda_host

inline int __float2int_rn(float x) { return rptv::cuda_host::saturated_int(nearbyintf(x)); }
inline int __float2int_rz(float x) { return rptv::cuda_host::saturated_int(truncf(x)); }
inline int __float2int_rd(float x) { return rptv::cuda_host::saturated_int(floorf(x)); }
inline int __float2int_ru(float x) { return rptv::cuda_host::saturated_int(ceilf(x)); }
inline int __float_as_int(float x) { return rptv::cuda_host::bits_as<int>(x); }
inline unsigned __float_as_uint(float x) { return rptv::cuda_host::bits_as<unsigned>(x); }
inline float __int_as_float(int x) { return rptv::cuda_host::bits_as<float>(x); }
inline float __uint_as_float(unsigned x) { return rptv::cuda_host::bits_as<float>(x); }
inline long long __double_as_longlong(double x) { return rptv::cuda_host::bits_as<long long>(x); }
inline double __longlong_as_double(long long x) { return rptv::cuda_host::bits_as<double>(x); }
