// SPDX-License-Identifier: MIT
// What a machine is told about its GPU.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reconstruct/cuda_probe.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

TEST(CudaProbe, names_a_device_or_says_in_one_line_what_is_missing) {
  const CudaProbe probe = probe_cuda();
  EXPECT_EQ(probe.usable, probe.device >= 0);
  EXPECT_FALSE(probe.text.empty());
  EXPECT_EQ(probe.text.find('\n'), std::string::npos);
#if !defined(RPTV_HAVE_CUDA)
  EXPECT_FALSE(probe.usable);
  EXPECT_THAT(probe.text, HasSubstr("built without CUDA"));
#endif
}

TEST(CudaProbe, says_the_same_when_it_is_asked_again) { EXPECT_EQ(probe_cuda().text, probe_cuda().text); }

}  // namespace
}  // namespace rptv
