// SPDX-License-Identifier: MIT
// A progress bar with rate and remaining time, on a terminal only, for what takes longer than a moment.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>

namespace rptv {

/// One line of at most `columns` characters: what, bar, share, done of total, rate, time left. Pure.
std::string progress_line(const std::string& what, std::uint64_t done, std::uint64_t total, double elapsed_s,
                          std::size_t columns);

/// Draws on stderr when that is a terminal, from half a second on, ten times a second at most; silent otherwise.
/// advance(): any thread. The destructor clears the line.
class Progress {
 public:
  Progress(std::string what, std::uint64_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void advance(std::uint64_t steps = 1);
  std::uint64_t done() const noexcept { return done_.load(std::memory_order_relaxed); }

 private:
  void draw(std::uint64_t done, std::int64_t now_ns);

  const std::string what_;
  const std::uint64_t total_;
  const bool terminal_;
  const std::int64_t start_ns_;
  std::atomic<std::uint64_t> done_{0};
  std::atomic<std::int64_t> next_ns_;
  std::mutex drawing_;
  bool drawn_ = false;
};

}  // namespace rptv
