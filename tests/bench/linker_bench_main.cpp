// SPDX-License-Identifier: MIT
// rptv_bench_linker: the linker's figures over seeded workloads that it makes itself.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/bench/linker_bench.hpp"

namespace rptv {
namespace {

using Steps = MovingPoints::Steps;

constexpr const char* kUsage =
    "usage: rptv_bench_linker                             all of the below\n"
    "       rptv_bench_linker table [FRAMES] [RUNS]       cost of a frame; the run with the least median of each case\n"
    "       rptv_bench_linker growth|judge|hostile|hour   cost with N and density; tracks against the truth; inputs\n"
    "                                                     that nobody should send; memory over an hour\n"
    "       rptv_bench_linker one|points CASE N RATIO RANGE PREDICT FRAMES   one line of the table; or its points, "
    "CSV\n"
    "CASE: walk, gauss, flow; PREDICT: as linker.predict";

void print_line(const LinkCase& c, std::size_t frames, std::size_t runs) {
  LinkTimes best;
  for (std::size_t run = 0; run < runs; ++run) {
    LinkTimes times = measure(c, frames, 1);
    if (run == 0 || percentile(times.frame_ms, 0.5) < percentile(best.frame_ms, 0.5)) best = std::move(times);
  }
  const double p50 = percentile(best.frame_ms, 0.5);
  std::printf("%-6s %6zu %5.2f %6.3f %-9s %8.3f %8.3f %8.3f %8.3f %7.1f %8.3f %7.4f %8llu %6llu\n", c.name.c_str(),
              c.count, c.ratio, c.search_range_mm, c.predict.substr(0, 9).c_str(), p50, percentile(best.frame_ms, 0.99),
              percentile(best.frame_ms, 0.999), percentile(best.frame_ms, 1.0),
              p50 * 1e6 / static_cast<double>(c.count), percentile(best.floor_ms, 0.5), best.right,
              static_cast<unsigned long long>(best.largest_subnet), static_cast<unsigned long long>(best.truncated));
  std::fflush(stdout);
}

void print_head() {
  std::puts("linking one frame: CPU time of one thread, ms; mean spacing 1; floor: sorting the particles into cells");
  std::puts(
      "case        N ratio  range predict        p50      p99    p99.9      max    ns/N    floor   right  largest  "
      "trunc");
}

void print_table(std::size_t frames, std::size_t runs) {
  print_head();
  for (const std::size_t n : {100, 1000, 5000, 20000}) {
    for (const double ratio : {0.1, 0.3, 0.5})
      print_line({"walk", Steps::walk, n, ratio, 1.05 * ratio, "none"}, frames, runs);
    print_line({"gauss", Steps::gauss, n, 0.3, 0.9, "none"}, frames, runs);
    for (const double range : {1.0, 1.5}) print_line({"gauss", Steps::gauss, n, 0.5, range, "none"}, frames, runs);
  }
  for (const char* predict : {"velocity", "flow", "kalman", "kalman_acceleration"})
    for (const std::size_t n : {1000, 5000, 20000})
      print_line({"flow", Steps::flow, n, 1.0, 0.25, predict}, frames, runs);
}

LinkCase case_of(char** argv) {
  LinkCase c;
  c.name = argv[2];
  c.steps = c.name == "gauss" ? Steps::gauss : c.name == "flow" ? Steps::flow : Steps::walk;
  c.count = std::stoul(argv[3]);
  c.ratio = std::stod(argv[4]);
  c.search_range_mm = std::stod(argv[5]);
  c.predict = argv[6];
  return c;
}

int run(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "all";
  const bool all = what == "all";
  if (what == "one" || what == "points") {
    if (argc != 8) return std::puts(kUsage), 64;
    if (what == "points") return write_points(case_of(argv), std::stoul(argv[7]), 1), 0;
    print_head();
    print_line(case_of(argv), std::stoul(argv[7]), 5);
    return 0;
  }
  if (all || what == "table") print_table(argc > 2 ? std::stoul(argv[2]) : 50, argc > 3 ? std::stoul(argv[3]) : 5);
  if (all || what == "growth") print_growth();
  if (all || what == "judge") print_judgement();
  if (all || what == "hostile") print_hostile();
  if (all || what == "hour") print_hour();
  const bool known =
      all || what == "table" || what == "growth" || what == "judge" || what == "hostile" || what == "hour";
  if (!known) std::puts(kUsage);
  return known ? 0 : 64;
}

}  // namespace
}  // namespace rptv

int main(int argc, char** argv) { return rptv::run(argc, argv); }
