// SPDX-License-Identifier: MIT
// rptv_bench_views [--rounds=N]: the DLT beside singular value decompositions, and matching from 100 to 4000 particles.
#include <cstdlib>
#include <iostream>
#include <string>

#include "tests/bench/contest.hpp"
#include "tests/bench/views_bench.hpp"

int main(int argc, char** argv) {
  int rounds = 20;
  for (int i = 1; i < argc; ++i)
    if (const std::string argument = argv[i]; argument.starts_with("--rounds="))
      rounds = std::max(1, std::atoi(argument.c_str() + 9));
  std::cout << rptv::bench::machine() << "; CPU time of one thread, medians of " << rounds << " alternating runs\n";
  rptv::bench::bench_dlt(std::cout, rounds);
  rptv::bench::bench_matching(std::cout, rounds);
  rptv::bench::bench_chain(std::cout, rounds);
}
