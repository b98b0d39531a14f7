// SPDX-License-Identifier: MIT
// CUDA's vector types with their alignment in device memory, and make_T() for each.
#pragma once

// clang-format off
#define RPTV_VECTOR_2(name, scalar, alignment)                                \
  struct alignas(alignment) name { scalar x, y; };                            \
  inline name make_##name(scalar x, scalar y) { return {x, y}; }
#define RPTV_VECTOR_3(name, scalar)                                           \
  struct name { scalar x, y, z; };                                            \
  inline name make_##name(scalar x, scalar y, scalar z) { return {x, y, z}; }
#define RPTV_VECTOR_4(name, scalar, alignment)                                \
  struct alignas(alignment) name { scalar x, y, z, w; };                      \
  inline name make_##name(scalar x, scalar y, scalar z, scalar w) { return {x, y, z, w}; }
// clang-format on

RPTV_VECTOR_2(char2, signed char, 2)
RPTV_VECTOR_2(uchar2, unsigned char, 2)
RPTV_VECTOR_2(short2, short, 4)
RPTV_VECTOR_2(ushort2, unsigned short, 4)
RPTV_VECTOR_2(int2, int, 8)
RPTV_VECTOR_2(uint2, unsigned, 8)
RPTV_VECTOR_2(longlong2, long long, 16)
RPTV_VECTOR_2(ulonglong2, unsigned long long, 16)
RPTV_VECTOR_2(float2, float, 8)
RPTV_VECTOR_2(double2, double, 16)
RPTV_VECTOR_3(uchar3, unsigned char)
RPTV_VECTOR_3(int3, int)
RPTV_VECTOR_3(uint3, unsigned)
RPTV_VECTOR_3(float3, float)
RPTV_VECTOR_3(double3, double)
RPTV_VECTOR_4(char4, signed char, 4)
RPTV_VECTOR_4(uchar4, unsigned char, 4)
RPTV_VECTOR_4(short4, short, 8)
RPTV_VECTOR_4(ushort4, unsigned short, 8)
RPTV_VECTOR_4(int4, int, 16)
RPTV_VECTOR_4(uint4, unsigned, 16)
RPTV_VECTOR_4(float4, float, 16)
RPTV_VECTOR_4(double4, double, 16)

#undef RPTV_VECTOR_2
#undef RPTV_VECTOR_3
#undef RPTV_VECTOR_4

/// Extent of a grid or a block; what is not given is 1.
struct dim3 {
  unsigned x, y, z;
  constexpr dim3(unsigned x_size = 1, unsigned y_size = 1, unsigned z_size = 1) : x(x_size), y(y_size), z(z_size) {}
  constexpr dim3(uint3 size) : x(size.x), y(size.y), z(size.z) {}
};
