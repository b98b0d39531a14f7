// SPDX-License-Identifier: MIT
// rptv_bench_ring [rounds]: prints the ring's table.
#include <cstdlib>
#include <iostream>

#include "tests/bench/ring_bench.hpp"

int main(int argc, char** argv) {
  rptv::RingBenchOptions options;
  if (argc > 1) options.rounds = std::max(1, std::atoi(argv[1]));
  rptv::bench_ring(std::cout, options);
}
