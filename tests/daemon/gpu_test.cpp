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

std::string content(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Gpu, stages_are_timed_by_bench) {
  const SmallRun run(4);
  const Said said =
      run_rapidptv({"bench", "--cuda", "--json", "--config", SimulatedRunFiles(run.folder()).rig.string()});
  if (said.code == static_cast<int>(ExitCode::unavailable)) {
    EXPECT_TRUE(said.out.empty());
    EXPECT_EQ(std::count(said.err.begin(), said.err.end(), '\n'), 1);
    GTEST_SKIP() << said.err;
  }
  ASSERT_EQ(said.code, 0) << said.err;
  std::cerr << said.err;
  for (const char* stage : {"upload", "lit pixels", "rays, sorted", "count", "maxima", "fits", "download"})
    EXPECT_NE(said.out.find("{\"stage\":\"" + std::string(stage) + "\""), std::string::npos) << said.out;
}

TEST(Gpu, finds_the_particles_of_the_cpu) {
  const SmallRun run(4);
  std::string points[2];
  for (const char* backend : {"cpu", "cuda"}) {
    const auto file = run.folder() / (std::string(backend) + ".csv");
    const Said said = run_rapidptv({"reconstruct", "--config", SimulatedRunFiles(run.folder()).rig.string(),
                                    "--backend", backend, "-o", file.string()});
    if (said.code == static_cast<int>(ExitCode::unavailable)) GTEST_SKIP() << said.err;
    ASSERT_EQ(said.code, 0) << said.err;
    points[backend == std::string("cuda")] = content(file);
  }
  EXPECT_GT(points[0].size(), 1000U);
  EXPECT_EQ(points[0], points[1]);
}

}  // namespace
}  // namespace rptv

int main(int argc, char** argv) {
  constexpr int kSkipped = 77;
  ::testing::InitGoogleTest(&argc, argv);
  const int failed = RUN_ALL_TESTS();
  return failed == 0 && ::testing::UnitTest::GetInstance()->skipped_test_count() > 0 ? kSkipped : failed;
}
