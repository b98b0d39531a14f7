// SPDX-License-Identifier: MIT
// CUDA's vector types with their alignment in device memory, and make_T() for each.
#pragma once

// clang-format off
#define RPTV_VECTORS(name, scalar, alignment_of_2, alignment_of_4)                                    \
  struct alignas(alignment_of_2) name##2 { scalar x, y; };                                            \
  struct name##3 { scalar x, y, z; };                                                                 \
  struct alignas(alignment_of_4) name##4 { scalar x, y, z, w; };                                      \
  inline name##2 make_##name##2(scalar x, scalar y) { return {x, y}; }                                \
  inline name##3 make_##name##3(scalar x, scalar y, scalar z) { return {x, y, z}; }                   \
  inline name##4 make_##name##4(scalar x, scalar y, scalar z, scalar w) { return {x, y, z, w}; }
// clang-format on

RPTV_VECTORS(char, signed char, 2, 4)
RPTV_VECTORS(uchar, unsigned char, 2, 4)
RPTV_VECTORS(short, short, 4, 8)
RPTV_VECTORS(ushort, unsigned short, 4, 8)
RPTV_VECTORS(int, int, 8, 16)
RPTV_VECTORS(uint, unsigned, 8, 16)
RPTV_VECTORS(longlong, long long, 16, 16)
RPTV_VECTORS(ulonglong, unsigned long long, 16, 16)
RPTV_VECTORS(float, float, 8, 16)
RPTV_VECTORS(double, double, 16, 16)

#undef RPTV_VECTORS

/// Extent of a grid or a block; what is not given is 1.
struct dim3 {
  unsigned x, y, z;
  constexpr dim3(unsigned x_size = 1, unsigned y_size = 1, unsigned z_size = 1) : x(x_size), y(y_size), z(z_size) {}
  constexpr dim3(uint3 size) : x(size.x), y(size.y), z(size.z) {}
};
