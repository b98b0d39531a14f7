// SPDX-License-Identifier: MIT
// Which processor reconstructs, for machines of every kind.
#include "daemon/backend.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;

const std::string kWork = "some work";
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
    EXPECT_TRUE(backend.device);
    EXPECT_EQ(backend.text, "reconstructing on Some GPU, 24 MiB");
  }
  EXPECT_FALSE(choose_backend(with("cpu"), kGpu).device);
}

TEST(Backend, is_the_cpu_by_itself_where_there_is_no_gpu_and_says_why) {
  const Backend backend = choose_backend(with("auto"), kNoDriver);
  EXPECT_FALSE(backend.device);
  EXPECT_EQ(backend.text, "reconstructing on the CPU: no NVIDIA driver is installed");
}

TEST(Backend, is_an_error_where_the_gpu_must_be_used_and_cannot) {
  EXPECT_THAT(refusal(with("cuda"), kNoDriver),
              HasSubstr("reconstruction.backend = \"cuda\": no NVIDIA driver is installed; "));
}

TEST(Backend, is_the_cpu_for_what_the_device_does_not_do) {
  Config dense = with("auto"), sweeps = with("auto"), exhaustive = with("auto");
  dense.reconstruction.kind = sweeps.reconstruction.kind = "multi_view";
  dense.multi_view.method = "iterative";
  exhaustive.light_field.counting = "exhaustive";
  for (const auto& [config, text] : {std::pair(&dense, "multi_view.method = \"iterative\" runs on the CPU only"),
                                     std::pair(&sweeps, "multi_view.detector.overlap_sweeps = 6"),
                                     std::pair(&exhaustive, "\"exhaustive\" runs on the CPU only")}) {
    EXPECT_FALSE(choose_backend(*config, kGpu).device);
    config->reconstruction.backend = "cuda";
    EXPECT_THAT(refusal(*config, kGpu), HasSubstr(text));
  }
}

TEST(Backend, is_the_gpu_for_several_cameras_with_detectors_that_it_has) {
  Config config = with("auto");
  config.reconstruction.kind = "multi_view";
  config.multi_view.detector.method = "centroid";
  EXPECT_TRUE(choose_backend(config, kGpu).device);
}

TEST(Backend, is_the_gpu_after_a_trial_that_it_won_or_where_it_must_be_used) {
  const DeviceTrial won{"", 2.5, 1.25}, lost{"", 0.5, 1.25};
  const Backend faster = judge(with("auto"), "Some GPU", won, kWork);
  EXPECT_TRUE(faster.device);
  EXPECT_EQ(faster.text, "reconstructing on Some GPU: 1.25 ms to some work, the CPU takes 2.50");
  const Backend slower = judge(with("auto"), "Some GPU", lost, kWork);
  EXPECT_FALSE(slower.device);
  EXPECT_EQ(slower.text, "reconstructing on the CPU: 0.50 ms to some work, Some GPU takes 1.25");
  EXPECT_TRUE(judge(with("cuda"), "Some GPU", lost, kWork).device);
}

TEST(Backend, is_never_a_gpu_that_gives_other_results) {
  const DeviceTrial wrong{"it finds other rays", 0, 0};
  const Backend backend = judge(with("auto"), "Some GPU", wrong, kWork);
  EXPECT_FALSE(backend.device);
  EXPECT_THAT(backend.text,
              HasSubstr("Some GPU does not repeat what the CPU makes of a test image: it finds other rays"));
  EXPECT_THROW(judge(with("cuda"), "Some GPU", wrong, kWork), Error);
}

}  // namespace
}  // namespace rptv
