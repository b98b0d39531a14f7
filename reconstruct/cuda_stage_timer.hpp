// SPDX-License-Identifier: MIT
// How long each stage of a frame takes on the device, and what it moves, by events between the stages of its streams.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "reconstruct/cuda_stream.hpp"

namespace rptv {

/// In the order of the work. `none`: time that no stage answers for, such as the host's turn between two of them.
// clang-format off
enum class CudaStage : std::uint8_t {
  none, upload, lit_pixels, rays, count, maxima, fits, detection, cells, pairs, tuples, dlt, ghosts, download, end
};
// clang-format on
constexpr std::size_t kCudaStages = static_cast<std::size_t>(CudaStage::end);
/// As tables have it.
inline const char* name_of(CudaStage stage) noexcept {
  constexpr std::array<const char*, kCudaStages> kNames{
      "between stages", "upload",         "lit pixels",     "rays, sorted",    "count", "maxima", "fits",
      "detection",      "cells of views", "pairs of views", "tuples of views", "dlt",   "ghosts", "download"};
  return kNames[static_cast<std::size_t>(stage)];
}

/// Copies count by their bytes in the stage that they are queued in, kernels by what CudaStream::tell() says.
struct StageCost {
  double device_ms = 0;
  std::uint64_t bytes = 0, increments = 0;
};
using StageCosts = std::array<StageCost, kCudaStages>;
inline StageCost& of(StageCosts& costs, CudaStage stage) { return costs[static_cast<std::size_t>(stage)]; }
inline const StageCost& of(const StageCosts& costs, CudaStage stage) { return costs[static_cast<std::size_t>(stage)]; }

/// The marks of one stream, which its thread makes while its timer records.
class StageMarks {
 public:
  static constexpr std::size_t kMostMarks = 1024;

  StageMarks();                   ///< throws Error(unavailable)
  void record(bool on) noexcept;  ///< on: forgets all marks
  void begin(CudaStage stage, const CudaStream& stream) noexcept;
  CudaStage now() const noexcept { return now_; }
  bool recording() const noexcept { return recording_; }
  void add(CudaStage stage, std::size_t bytes, std::uint64_t increments) noexcept;
  /// Waits for the last mark and adds what was recorded; false when the runtime refused an event, or marks had no room.
  bool read(StageCosts& sum) noexcept;

 private:
  struct Mark {
    CudaEvent event{CudaEvent::Use::time};
    CudaStage stage = CudaStage::none;
  };
  std::unique_ptr<Mark[]> marks_;
  std::size_t size_ = 0;
  bool recording_ = false, good_ = true;
  CudaStage now_ = CudaStage::none;
  StageCosts costs_{};
};

/// Watches all streams that its thread makes while it lives; they may outlive it. For benches and tests: production has
/// none, and a stream without one tests a pointer. One at a time in a thread; streams are idle at start() and stop().
class StageTimer {
 public:
  StageTimer();
  ~StageTimer();
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;

  void start() noexcept;
  /// What all streams did since start(); false as StageMarks::read().
  bool stop(StageCosts& costs) noexcept;

  /// For a new stream of this thread; null where nobody watches. Throws Error(unavailable).
  static std::shared_ptr<StageMarks> new_marks();

 private:
  std::vector<std::shared_ptr<StageMarks>> streams_;
};

}  // namespace rptv
