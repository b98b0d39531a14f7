// SPDX-License-Identifier: MIT
// Which processor reconstructs, for machines of every kind.
#include "daemon/backend.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

const CudaProbe kGpu{true, 0, "Some GPU, 24 MiB"}, kNoDriver{false, -1, "no NVIDIA driver is installed"};

Config with(const std::string& backend) {
  Config config;
  config.reconstruction.backend = backend;
  return config;
}

std::string refusal(const Config& config, const CudaProbe& probe) {
  try {
    choose_backend(config, probe);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::unavailable);
    return error.what();
  }
  return {};
}

TEST(Backend, is_the_gpu_where_there_is_one_and_nothing_forbids_it) {
  for (const char* wanted : {"auto", "cuda"}) {
    const Backend backend = choose_backend(with(wanted), kGpu);
    EXPECT_NE(backend.make_device, nullptr);
    EXPECT_EQ(backend.text, "reconstructing on Some GPU, 24 MiB");
  }
  EXPECT_EQ(choose_backend(with("cpu"), kGpu).make_device, nullptr);
}

TEST(Backend, is_the_cpu_by_itself_where_there_is_no_gpu_and_says_why) {
  const Backend backend = choose_backend(with("auto"), kNoDriver);
  EXPECT_EQ(backend.make_device, nullptr);
  EXPECT_EQ(backend.text, "reconstructing on the CPU: no NVIDIA driver is installed");
}

TEST(Backend, is_an_error_where_the_gpu_must_be_used_and_cannot) {
  EXPECT_THAT(refusal(with("cuda"), kNoDriver),
              HasSubstr("reconstruction.backend = \"cuda\": no NVIDIA driver is installed; "));
}

TEST(Backend, is_the_cpu_for_what_the_device_does_not_do) {
  Config views = with("auto"), exhaustive = with("auto");
  views.reconstruction.kind = "multi_view";
  exhaustive.light_field.counting = "exhaustive";
  for (Config* config : {&views, &exhaustive}) {
    EXPECT_EQ(choose_backend(*config, kGpu).make_device, nullptr);
    config->reconstruction.backend = "cuda";
    EXPECT_THAT(refusal(*config, kGpu), HasSubstr("runs on the CPU only"));
  }
}

}  // namespace
}  // namespace rptv
