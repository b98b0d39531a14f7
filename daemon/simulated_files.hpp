// SPDX-License-Identifier: MIT
// What the simulated runs of light-field cameras and of rigs have in common: their files, and threads over their
// frames.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "simulation/scenario.hpp"

namespace rptv {

/// Creates a folder and those above it. Throws Error (permission, io).
void make_folder(const std::filesystem::path& folder);

/// Removes frame_*.png: frames of an earlier, longer run would be replayed behind these.
void remove_frames(const std::filesystem::path& frames);

/// Throws Error(io).
void write_text(const std::filesystem::path& file, const std::string& text);

/// frames.csv: the time of every frame.
void write_times(const ScenarioSettings& scenario, const std::filesystem::path& file);

/// The scenario as a file that gives it back.
std::string scenario_toml(ScenarioSettings scenario);

/// Calls copies of `worker`, one per thread, with the frames 0 to count - 1, each once. Throws the first error of any
/// thread. `threads` 0: one per processor.
template <class Worker>
void on_frames(std::uint64_t count, unsigned threads, const Worker& worker) {
  std::atomic<std::uint64_t> next{0};
  std::mutex failing;
  std::exception_ptr error;
  const auto work = [&](Worker mine) {
    try {
      for (std::uint64_t frame = next++; frame < count; frame = next++) mine(frame);
    } catch (...) {
      const std::lock_guard lock(failing);
      if (!error) error = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> running;
  for (unsigned i = 0; i < (threads > 0 ? threads : std::max(1U, std::thread::hardware_concurrency())); ++i)
    running.emplace_back([&] { work(worker); });
  for (auto& thread : running) thread.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace rptv
