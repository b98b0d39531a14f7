// SPDX-License-Identifier: MIT
// What only a GPU can show: the shipped binary on it. Skipped, with the reason, where there is none.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <iterator>

#include "core/error.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/daemon/small_run.hpp"

namespace rptv {
namespace {

using testing::run_rapidptv;
using testing::Said;
using testing::SmallRun;

bool needs_a_gpu(const Said& said) { return said.code == static_cast<int>(ExitCode::unavailable); }

/// Table and JSON of `bench --cuda`; other settings than the configuration's follow.
Said bench(const std::filesystem::path& config, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words{"bench", "--cuda", "--json", "--rounds", "2", "--config", config.string()};
  words.insert(words.end(), more.begin(), more.end());
  return run_rapidptv(words);
}

void expect_stages(const Said& said, const std::vector<std::string>& stages) {
  ASSERT_EQ(said.code, 0) << said.err;
  std::cerr << said.err;
  for (const std::string& stage : stages)
    EXPECT_NE(said.out.find("{\"stage\":\"" + stage + "\""), std::string::npos) << stage << " in " << said.out;
}

/// The table of points of `reconstruct`; `said` becomes what it said.
std::string points(const std::filesystem::path& config, const std::string& backend, Said& said,
                   const std::vector<std::string>& more = {}) {
  const auto file = config.parent_path() / (backend + ".csv");
  std::vector<std::string> words{"reconstruct", "--config", config.string(), "--backend", backend, "-o", file.string()};
  words.insert(words.end(), more.begin(), more.end());
  said = run_rapidptv(words);
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Gpu, stages_of_a_light_field_are_timed) {
  const SmallRun run(4);
  const Said said = bench(SimulatedRunFiles(run.folder()).rig);
  if (needs_a_gpu(said)) {
    EXPECT_TRUE(said.out.empty());
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1);
    GTEST_SKIP() << said.err;
  }
  expect_stages(said, {"upload", "lit pixels", "rays, sorted", "count", "maxima", "fits", "download"});
}

TEST(Gpu, finds_the_particles_of_the_cpu_in_a_light_field) {
  const SmallRun run(4);
  const auto config = SimulatedRunFiles(run.folder()).rig;
  Said cpu, cuda;
  const std::string found = points(config, "cuda", cuda), expected = points(config, "cpu", cpu);
  if (needs_a_gpu(cuda)) GTEST_SKIP() << cuda.err;
  EXPECT_EQ(cuda.code, 0) << cuda.err;
  EXPECT_GT(expected.size(), 1000U);
  EXPECT_EQ(found, expected);
}

TEST(Gpu, detects_the_particle_images_of_the_cpu_in_several_views) {
  const SmallRun run(1);  // for its folder
  const auto folder = run.folder() / "views";
  const std::vector<std::string> plain{"--set", "multi_view.detector.overlap_sweeps=0"};
  const Said made = run_rapidptv({"simulate", "--scenario", RPTV_SOURCE_DIR "/simulation/scenarios/lpt_challenge.toml",
                                  "--out", folder.string(), "--set", "frames=2", "--set", "views.per_pixel=0.001"});
  ASSERT_EQ(made.code, 0) << made.err;
  Said cpu, cuda;
  const std::string found = points(folder / "rig.toml", "cuda", cuda, plain),
                    expected = points(folder / "rig.toml", "cpu", cpu, plain);
  if (needs_a_gpu(cuda)) GTEST_SKIP() << cuda.err;
  EXPECT_EQ(cuda.code, 0) << cuda.err;
  EXPECT_GT(expected.size(), 1000U);
  EXPECT_EQ(found, expected);
  expect_stages(bench(folder / "rig.toml", plain), {"upload", "detection", "download"});
}

}  // namespace
}  // namespace rptv

int main(int argc, char** argv) {
  constexpr int kSkipped = 77;
  ::testing::InitGoogleTest(&argc, argv);
  const int failed = RUN_ALL_TESTS();
  return failed == 0 && ::testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? kSkipped : failed;
}
