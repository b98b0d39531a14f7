// SPDX-License-Identifier: MIT
// rptv_bench_light_field [TABLE…] [--rounds=N] [--dump=PREFIX]: prints the light field's tables, all of them or those
// named.
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "tests/bench/contest.hpp"
#include "tests/bench/light_field_bench.hpp"

namespace {

struct Table {
  const char* name;
  void (*print)(std::ostream&, const rptv::bench::LightFieldBenchOptions&);
};

constexpr Table kTables[]{
    {"counting", rptv::bench::bench_counting},     {"classification", rptv::bench::bench_classification},
    {"lit_pixels", rptv::bench::bench_lit_pixels}, {"frames", rptv::bench::bench_frames},
    {"baselines", rptv::bench::bench_baselines},   {"accuracy", rptv::bench::bench_accuracy},
    {"density", rptv::bench::bench_density},       {"ghosts", rptv::bench::bench_ghosts}};

// As the daemon runs: OpenMP's workers sleep between frames instead of spinning on the cores of others.
void let_openmp_sleep(char** argv) {
  if (getenv("OMP_WAIT_POLICY") != nullptr) return;
  setenv("OMP_WAIT_POLICY", "passive", 1);
  setenv("GOMP_SPINCOUNT", "10000", 0);
  execv("/proc/self/exe", argv);
}

}  // namespace

int main(int argc, char** argv) {
  let_openmp_sleep(argv);
  std::vector<std::string> wanted;
  rptv::bench::LightFieldBenchOptions options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("--rounds="))
      options.rounds = std::max(1, std::atoi(argument.c_str() + 9));
    else if (argument.starts_with("--dump="))
      options.dump = argument.substr(7);
    else
      wanted.push_back(argument);
  }
  std::cout << rptv::bench::machine() << "; CPU time of one thread, medians of " << options.rounds
            << " alternating runs\n";
  for (const auto& table : kTables)
    if (wanted.empty() || std::find(wanted.begin(), wanted.end(), table.name) != wanted.end())
      table.print(std::cout, options);
}
