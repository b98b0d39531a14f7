// SPDX-License-Identifier: MIT
// Clocks, medians and the alternation.
#include "tests/bench/contest.hpp"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <thread>

namespace rptv::bench {

double thread_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

std::string machine() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  const std::string cores = ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
  for (std::string line; std::getline(cpuinfo, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2) + cores;
  return "unknown processor" + cores;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::size_t Contest::add(std::string name, std::function<void()> run) {
  all_.push_back({std::move(name), std::move(run), {}});
  return all_.size() - 1;
}

void Contest::run(int rounds) {
  for (auto& one : all_) one.run();
  for (int round = 0; round < rounds; ++round)
    for (auto& one : all_) {
      const double begin_ms = thread_cpu_ms();
      one.run();
      one.ms.push_back(thread_cpu_ms() - begin_ms);
    }
}

double Contest::least_ms(std::size_t i) const { return *std::min_element(all_[i].ms.begin(), all_[i].ms.end()); }

}  // namespace rptv::bench
