// SPDX-License-Identifier: MIT
// Times contenders in alternating runs, by the CPU time of the calling thread, on a machine that others use too.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace rptv::bench {

/// CPU time of the calling thread, ms.
double thread_cpu_ms();

/// Processor and number of cores, as the tables name them.
std::string machine();

/// Lower middle value.
double median(std::vector<double> values);

/// Adds contenders, runs them round by round (so that a busy minute hits all of them), and gives medians.
class Contest {
 public:
  /// `run` is called once to warm up and once a round. Returns the contender's number.
  std::size_t add(std::string name, std::function<void()> run);
  void run(int rounds);

  std::size_t size() const { return all_.size(); }
  const std::string& name(std::size_t i) const { return all_[i].name; }
  double median_ms(std::size_t i) const { return median(all_[i].ms); }
  double least_ms(std::size_t i) const;

 private:
  struct Contender {
    std::string name;
    std::function<void()> run;
    std::vector<double> ms;
  };
  std::vector<Contender> all_;
};

}  // namespace rptv::bench
