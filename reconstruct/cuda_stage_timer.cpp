// SPDX-License-Identifier: MIT
// Marks in streams, and the sums over them.
#include "reconstruct/cuda_stage_timer.hpp"

namespace rptv {

namespace {

thread_local StageTimer* watching = nullptr;

}  // namespace

StageMarks::StageMarks() : marks_(std::make_unique<Mark[]>(kMostMarks)) {}

void StageMarks::record(bool on) noexcept {
  recording_ = on;
  if (!on) return;
  size_ = 0, good_ = true, now_ = CudaStage::none, costs_ = {};
}

void StageMarks::begin(CudaStage stage, const CudaStream& stream) noexcept {
  if (!recording_) return;
  now_ = stage;
  if (size_ == kMostMarks) {
    good_ = false;
    return;
  }
  Mark& mark = marks_[size_++];
  mark.stage = stage;
  good_ = mark.event.record(stream) && good_;
}

void StageMarks::add(CudaStage stage, std::size_t bytes, std::uint64_t increments) noexcept {
  if (!recording_) return;
  StageCost& cost = of(costs_, stage);
  cost.bytes += bytes, cost.increments += increments;
}

bool StageMarks::read(StageCosts& sum) noexcept {
  bool good = good_ && (size_ == 0 || marks_[size_ - 1].event.synchronize());
  for (std::size_t i = 0; good && i + 1 < size_; ++i) {
    float elapsed_ms = 0;
    good = marks_[i].event.time_to(marks_[i + 1].event, elapsed_ms);
    of(sum, marks_[i].stage).device_ms += static_cast<double>(elapsed_ms);
  }
  for (std::size_t s = 0; s < kCudaStages; ++s) {
    sum[s].bytes += costs_[s].bytes, sum[s].increments += costs_[s].increments;
  }
  return good;
}

StageTimer::StageTimer() { watching = this; }
StageTimer::~StageTimer() { watching = nullptr; }

void StageTimer::start() noexcept {
  for (const auto& stream : streams_) stream->record(true);
}

bool StageTimer::stop(StageCosts& costs) noexcept {
  costs = {};
  bool good = true;
  for (const auto& stream : streams_) {
    stream->record(false);
    good = stream->read(costs) && good;
  }
  return good;
}

std::shared_ptr<StageMarks> StageTimer::new_marks() {
  if (watching == nullptr) return nullptr;
  return watching->streams_.emplace_back(std::make_shared<StageMarks>());
}

}  // namespace rptv
