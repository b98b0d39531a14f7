// SPDX-License-Identifier: MIT
// Launches that run PTX in place of C++: the text here differs from the kernels on purpose, so that one sees which ran.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "tests/cuda_host/device_values.hpp"
#include "tests/cuda_host/launch_config.hpp"

// By their names the PTX below is found; what they do is never run.
extern "C" {
__global__ void answer(unsigned* to) { *to = 1; }
__global__ void at_offset(unsigned* to, unsigned offset_bytes) { to[offset_bytes] = 1; }
__global__ void quotient(unsigned* to, unsigned divisor) { *to = divisor; }
__global__ void block_of_lanes(unsigned* to) { *to = 0; }
__global__ void not_in_the_file(unsigned*) {}
__global__ void of_other_size(unsigned) {}
}

namespace {

using rptv::cuda_host::DeviceValues;
using rptv::cuda_host::launch_of;
using testing::HasSubstr;

const char* const kText = R"(
.version 9.0
.target sm_75
.address_size 64
.visible .entry answer(.param .u64 p0) {
  .reg .b32 %r<3>;
  ld.param.u64 %rd1, [p0];
  mov.u32 %r1, 40;
  mov.u32 %r2, 0;
  {
    .reg .b32 %r1;  // not the one outside
    .reg .b32 %t<2>;
    mov.u32 %r1, 1;
    add.u32 %t0, %r1, 1;
    { .reg .b32 %r2, %r3; mov.u32 %r2, 7; mov.u32 %r3, 8; }
    add.u32 %r2, %r2, %t0;
  }
  add.u32 %r1, %r1, %r2;
  st.global.u32 [%rd1], %r1;  // 42; the C++ says 1
  ret;
}
.visible .entry at_offset(.param .u64 p0, .param .u32 p1) {
  ld.param.u64 %rd1, [p0];
  ld.param.u32 %r1, [p1];
  cvt.u64.u32 %rd2, %r1;
  add.s64 %rd3, %rd1, %rd2;
  st.global.u32 [%rd3], %r1;
  ret;
}
.visible .entry quotient(.param .u64 p0, .param .u32 p1) {
  ld.param.u64 %rd1, [p0];
  ld.param.u32 %r1, [p1];
  div.u32 %r2, 100, %r1;
  st.global.u32 [%rd1], %r2;
  ret;
}
.visible .entry block_of_lanes(.param .u64 p0) {
  .shared .align 4 .u32 sum;
  ld.param.u64 %rd1, [p0];
  mov.u32 %r1, %tid.x;
  setp.eq.u32 %p1|%p2, %r1, 0;
  @%p2 bra counted;
  st.shared.u32 [sum], 0;
counted:
  bar.sync 0;
  red.shared.add.u32 [sum], %r1;
  bar.red.popc.u32 %r2, 0, %p2;
  shfl.sync.idx.b32 %r3|%p3, %r1, 5, 31, -1;
  vote.sync.ballot.b32 %r4, %p1, -1;
  @!%p1 bra done;
  ld.shared.u32 %r5, [sum];
  st.global.v4.u32 [%rd1], {%r5, %r2, %r3, %r4};
  mov.b64 %rd2, {%r5, %r2};
  st.global.u64 [%rd1+16], %rd2;
done:
  exit;
}
.visible .entry of_other_size(.param .u64 p0) { ret; }
)";

class PtxLaunch : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    file_ = testing::TempDir() + "ptx_launch_test_" + std::to_string(getpid()) + ".ptx";
    std::ofstream(file_) << kText;
    setenv("RPTV_CUDA_PTX", file_.c_str(), 1);
  }
  static void TearDownTestSuite() {
    unsetenv("RPTV_CUDA_PTX");
    std::remove(file_.c_str());
  }
  ~PtxLaunch() override { rptv::cuda_host::forget_faults(); }

  template <class... Parameters, class... Arguments>
  static cudaError_t run(unsigned threads, void (*kernel)(Parameters...), Arguments... arguments) {
    const cudaLaunchConfig_t launch = launch_of(1, threads);
    const cudaError_t error = cudaLaunchKernelEx(&launch, kernel, arguments...);
    return error == cudaSuccess ? cudaDeviceSynchronize() : error;
  }

  static std::string file_;
  const DeviceValues<unsigned> values_{std::vector<unsigned>(8, 0)};
};
std::string PtxLaunch::file_;

TEST_F(PtxLaunch, runs_the_text_and_not_the_function) {
  ASSERT_EQ(run(1, answer, values_.get()), cudaSuccess) << rptv::cuda_host::last_fault();
  EXPECT_EQ(values_.read()[0], 42u);
}

TEST_F(PtxLaunch, meets_in_block_and_warp) {
  ASSERT_EQ(run(64, block_of_lanes, values_.get()), cudaSuccess) << rptv::cuda_host::last_fault();
  EXPECT_THAT(values_.read(), testing::ElementsAre(64 * 63 / 2, 63, 5, 1, 64 * 63 / 2, 63, 0, 0));
}

TEST_F(PtxLaunch, stores_where_it_says) {
  ASSERT_EQ(run(1, at_offset, values_.get(), 28u), cudaSuccess);
  EXPECT_EQ(values_.read()[7], 28u);
}

TEST_F(PtxLaunch, store_past_a_block_names_line_and_place) {
  EXPECT_EQ(run(1, at_offset, values_.get(), 32u), cudaErrorLaunchFailure);
  EXPECT_THAT(rptv::cuda_host::last_fault(),
              testing::AllOf(HasSubstr(".ptx:27"), HasSubstr("offset 32 of a block of 32 bytes")));
}

TEST_F(PtxLaunch, address_must_be_a_multiple_of_the_size) {
  EXPECT_EQ(run(1, at_offset, values_.get(), 2u), cudaErrorLaunchFailure);
  EXPECT_THAT(rptv::cuda_host::last_fault(), HasSubstr("no multiple of 4"));
}

TEST_F(PtxLaunch, integers_are_not_divided_by_zero) {
  ASSERT_EQ(run(1, quotient, values_.get(), 7u), cudaSuccess);
  EXPECT_EQ(values_.read()[0], 14u);
  EXPECT_EQ(run(1, quotient, values_.get(), 0u), cudaErrorLaunchFailure);
  EXPECT_THAT(rptv::cuda_host::last_fault(), HasSubstr("division by zero"));
}

TEST_F(PtxLaunch, kernel_without_text_is_refused) {
  EXPECT_EQ(run(1, not_in_the_file, values_.get()), cudaErrorInvalidDeviceFunction);
  EXPECT_THAT(rptv::cuda_host::last_fault(), HasSubstr("no PTX of the kernel 'not_in_the_file'"));
}

TEST_F(PtxLaunch, arguments_must_be_those_of_the_text) {
  EXPECT_EQ(run(1, of_other_size, 1u), cudaErrorInvalidDeviceFunction);
  EXPECT_THAT(rptv::cuda_host::last_fault(), HasSubstr("8 bytes in PTX and 4 in C++"));
}

}  // namespace
