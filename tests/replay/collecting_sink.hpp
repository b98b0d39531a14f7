// SPDX-License-Identifier: MIT
// A sink that keeps a copy of everything it is given, in order of delivery over all cameras.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "acquisition/source.hpp"
#include "tests/replay/image_maker.hpp"

namespace rptv::testing {

struct Received {
  FrameInfo info;
  Picture picture;
};

class CollectingSink final : public FrameSink {
 public:
  explicit CollectingSink(const Source& source, std::size_t slots = 4) {
    for (const CameraInfo& camera : source.cameras())
      pools_.push_back(std::make_unique<FramePool>(slots, camera.shape.bytes()));
  }

  FrameLease claim(std::uint32_t camera) noexcept override { return pools_[camera]->claim(); }
  void deliver(Frame&& frame) noexcept override {
    const Frame mine = std::move(frame);
    const std::lock_guard lock(mutex_);
    const std::byte* pixels = mine.lease.get();
    received_.push_back({mine.info, {mine.shape, {pixels, pixels + mine.shape.bytes()}}});
    changed_.notify_all();
  }
  void lose(std::uint32_t, LossCause, std::uint64_t) noexcept override {}
  void end() noexcept override {
    const std::lock_guard lock(mutex_);
    ++ends_;
    changed_.notify_all();
  }

  /// False when a minute was not enough.
  bool wait_for_end() {
    return wait([this] { return ends_ > 0; });
  }
  bool wait_for_frames(std::size_t count) {
    return wait([this, count] { return received_.size() >= count; });
  }

  /// After stop() of the source only.
  const std::vector<Received>& received() const { return received_; }
  std::vector<Received> received(std::uint32_t camera) const {
    std::vector<Received> own;
    for (const Received& frame : received_)
      if (frame.info.camera == camera) own.push_back(frame);
    return own;
  }
  int ends() const { return ends_; }

 private:
  template <class Condition>
  bool wait(Condition condition) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::minutes(1), condition);
  }
  std::vector<std::unique_ptr<FramePool>> pools_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Received> received_;
  int ends_ = 0;
};

}  // namespace rptv::testing
