// SPDX-License-Identifier: MIT
// The interpreter of PTX by itself: rounding and conversions against their definitions, and what it refuses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cfenv>
#include <cmath>
#include <limits>

#include "tests/cuda_host/ptx_functions.hpp"
#include "tests/cuda_host/ptx_kernels.hpp"
#include "tests/cuda_host/ptx_program.hpp"

namespace rptv::cuda_host {
namespace {

constexpr PtxType kS16{'s', 16}, kU32{'u', 32}, kS32{'s', 32}, kU64{'u', 64}, kS64{'s', 64}, kB32{'b', 32},
    kF32{'f', 32}, kF64{'f', 64};

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }
double real(std::uint64_t value) { return std::bit_cast<double>(value); }

/// a + b as the processor rounds it towards zero.
double sum_of_the_processor(double a, double b) {
  volatile double x = a, y = b;
  std::fesetround(FE_TOWARDZERO);
  volatile double sum = x + y;
  std::fesetround(FE_TONEAREST);
  return sum;
}

RC_GTEST_PROP(Ptx, sum_towards_zero_is_the_processors, (int m, int n, std::int8_t shift)) {
  const double a = m / 3.0, b = std::ldexp(n / 7.0, shift);
  RC_ASSERT(real(ptx_float_function("add.rz", kF64)(bits(a), bits(b), 0)) == sum_of_the_processor(a, b));
}

TEST(Ptx, sum_towards_zero_stops_before_infinity) {
  const double most = std::numeric_limits<double>::max();
  EXPECT_EQ(real(ptx_float_function("add.rz", kF64)(bits(most), bits(most), 0)), most);
  EXPECT_EQ(real(ptx_float_function("add.rn", kF64)(bits(most), bits(most), 0)),
            std::numeric_limits<double>::infinity());
}

RC_GTEST_PROP(Ptx, high_and_low_words_make_the_product, (std::int32_t a, std::int32_t b)) {
  const auto x = static_cast<std::uint32_t>(a), y = static_cast<std::uint32_t>(b);
  const std::uint64_t high = ptx_integer_function("mul.hi", kS32)(x, y, 0),
                      low = ptx_integer_function("mul.lo", kS32)(x, y, 0);
  RC_ASSERT(static_cast<std::int64_t>(high << 32 | low) == std::int64_t{a} * b);
  RC_ASSERT(static_cast<std::int64_t>(ptx_integer_function("mul.wide", kS32)(x, y, 0)) == std::int64_t{a} * b);
  RC_ASSERT(ptx_integer_function("mul.wide", kU32)(x, y, 0) == std::uint64_t{x} * y);
}

TEST(Ptx, shifts_beyond_the_width_leave_nothing_or_the_sign) {
  EXPECT_EQ(ptx_integer_function("shl", kB32)(1, 32, 0), 0u);
  EXPECT_EQ(ptx_integer_function("shr", kU32)(0x80000000u, 40, 0), 0u);
  EXPECT_EQ(ptx_integer_function("shr", kS32)(0x80000000u, 40, 0), 0xffffffffu);
}

TEST(Ptx, conversions_saturate) {
  EXPECT_EQ(ptx_convert(bits(3e9), kF64, kS32, "rzi"), 0x7fffffffu);
  EXPECT_EQ(ptx_convert(bits(-3e9), kF64, kS32, "rzi"), 0x80000000u);
  EXPECT_EQ(ptx_convert(bits(-1.0), kF64, kU32, "rzi"), 0u);
  EXPECT_EQ(ptx_convert(bits(1e300), kF64, kU64, "rzi"), ~std::uint64_t{0});
  EXPECT_EQ(ptx_convert(bits(std::nan("")), kF64, kS32, "rzi"), 0u);
  EXPECT_EQ(ptx_convert(bits(-2.5), kF64, kS64, "rni"), static_cast<std::uint64_t>(-2));
  EXPECT_EQ(ptx_convert(bits(-2.5), kF64, kS64, "rmi"), static_cast<std::uint64_t>(-3));
  EXPECT_EQ(ptx_convert(0xffffu, kS16, kS32, ""), 0xffffffffu);
  EXPECT_EQ(ptx_convert(0xffffffffu, kU32, kF32, "rn"), std::bit_cast<std::uint32_t>(4294967296.0f));
}

TEST(Ptx, relations_know_numbers_from_others) {
  const std::uint64_t nan = bits(std::nan("")), one = bits(1.0);
  EXPECT_EQ(ptx_comparison("ne", kF64)(nan, one, 0), 0u);
  EXPECT_EQ(ptx_comparison("neu", kF64)(nan, one, 0), 1u);
  EXPECT_EQ(ptx_comparison("ltu", kF64)(nan, one, 0), 1u);
  EXPECT_EQ(ptx_comparison("num", kF64)(nan, one, 0), 0u);
  EXPECT_EQ(ptx_comparison("lt", kS32)(0xffffffffu, 0, 0), 1u);
  EXPECT_EQ(ptx_comparison("lt", kU32)(0xffffffffu, 0, 0), 0u);
}

TEST(Ptx, bytes_are_put_together) {
  EXPECT_EQ(ptx_bit_field_function("prmt", kB32)(0x33221100u, 0x77665544u, 0x7531u), 0x77553311u);
  EXPECT_EQ(ptx_bit_field_function("prmt", kB32)(0x80u, 0, 0x8888u), 0xffffffffu);
  EXPECT_EQ(ptx_bit_field_function("lop3", kB32)(0xf0u, 0xccu, 0xaau | std::uint64_t{0x96} << 32), 0x96u);
  EXPECT_EQ(ptx_bit_field_function("bfi", kB32)(0x5u, 0xffffu, 4 | std::uint64_t{4} << 32), 0xff5fu);
  EXPECT_EQ(ptx_bit_field_function("shf.l.wrap", kB32)(0x80000000u, 1, 1), 3u);
}

std::string refusal_of(const std::string& statement) {
  try {
    parse_ptx(".visible .entry f(\n.param .u64 f_param_0)\n{\n" + statement + "\nret;\n}\n", "some.ptx");
  } catch (const PtxError& error) {
    return error.what();
  }
  return "";
}

TEST(Ptx, refuses_what_a_device_may_round_otherwise) {
  EXPECT_EQ(refusal_of("mul.rn.f64 %fd1, %fd2, %fd3;"), "");
  EXPECT_EQ(refusal_of("mul.f64 %fd1, %fd2, %fd3;"),
            "some.ptx:4: 'mul' without .rn may be fused; compile with --fmad=false");
  EXPECT_THAT(refusal_of("sqrt.approx.f32 %f1, %f2;"), testing::HasSubstr("not interpreted"));
  EXPECT_THAT(refusal_of("add.rn.ftz.f32 %f1, %f2, %f3;"), testing::HasSubstr("not interpreted"));
  EXPECT_THAT(refusal_of("red.global.add.f32 [%rd1], %f1;"), testing::HasSubstr("order is free"));
}

TEST(Ptx, refuses_what_it_does_not_know_by_line) {
  EXPECT_THAT(refusal_of("ret;\n\nwmma.load.a %r1, [%rd1];"), testing::StartsWith("some.ptx:6: "));
  EXPECT_THAT(refusal_of("bra $nowhere;"), testing::HasSubstr("no label"));
  EXPECT_THAT(refusal_of("call f, (%r1);"), testing::HasSubstr("a call"));
  EXPECT_THAT(refusal_of("ld.local.u32 %r1, [%rd1];"), testing::HasSubstr(".local"));
  EXPECT_THAT(refusal_of("mov.u32 %r1, elsewhere;"), testing::HasSubstr("'elsewhere' is not known"));
}

TEST(Ptx, lays_out_parameters_as_the_compiler_does) {
  const std::vector<PtxKernel> kernels = parse_ptx(
      ".extern .shared .align 16 .b8 dynamic[];\n.entry g(\n.param .u32 a,\n.param .u64 .ptr .align 1 b,\n.param "
      ".align 4 .b8 c[12]\n)\n"
      ".maxntid 256\n{ .shared .align 8 .f64 sums[4]; L: bra.uni L; }",
      "g.ptx");
  ASSERT_EQ(kernels.size(), 1u);
  ASSERT_EQ(kernels[0].parameters.size(), 3u);
  EXPECT_EQ(kernels[0].parameters[1].offset_bytes, 8u);
  EXPECT_EQ(kernels[0].parameters[2].size_bytes, 12u);
  EXPECT_EQ(kernels[0].parameter_bytes, 28u);
  ASSERT_EQ(kernels[0].shared.size(), 2u);
  EXPECT_EQ(kernels[0].shared[0].size_bytes, 0u);
  EXPECT_EQ(kernels[0].shared[1].size_bytes, 32u);
  EXPECT_EQ(kernels[0].instructions[0].target, 0u);
}

TEST(Ptx, knows_kernels_of_anonymous_namespaces) {
  EXPECT_EQ(common_name("_ZN4rptv44_GLOBAL__N__94d5b854_11_dlt_cuda_cu_bdcb8eab12solve_tuplesENS_3RowE"),
            "_ZN4rptv12_GLOBAL__N_112solve_tuplesENS_3RowE");
  EXPECT_EQ(common_name("_ZN4rptv4scanEPj"), "_ZN4rptv4scanEPj");
}

void of_this_executable() {}

TEST(Ptx, finds_local_functions_by_address) {
  EXPECT_THAT(symbol_at(reinterpret_cast<const void*>(&of_this_executable)), testing::HasSubstr("of_this_executable"));
}

}  // namespace
}  // namespace rptv::cuda_host
