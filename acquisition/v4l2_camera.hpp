// SPDX-License-Identifier: MIT
// One V4L2 camera over all its sessions: what its thread does while images come, and when the device goes away.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "acquisition/frame_counter.hpp"
#include "acquisition/source.hpp"
#include "acquisition/v4l2_device.hpp"
#include "acquisition/v4l2_loan.hpp"
#include "acquisition/v4l2_settings.hpp"
#include "core/descriptor.hpp"

namespace rptv {

/// begin() and run() use the sink from one thread at a time; status() and end(): any thread.
class V4l2Camera {
 public:
  /// Opens and sets up the device; throws Error. `pool_frames`: slots that the sink has for this camera.
  V4l2Camera(V4l2System& system, const std::string& path, const V4l2Settings& settings, std::uint32_t number,
             std::size_t pool_frames);

  CameraInfo info() const { return {path_, shape_, bits_}; }
  std::int64_t period_ns() const noexcept { return period_ns_; }

  /// Begins to stream; throws Error. Before run().
  void begin(FrameSink& sink);
  /// Delivers images until end(), on the camera's thread. A device that is lost is opened again when it is back.
  void run(FrameSink& sink) noexcept;
  /// Ends run(). Any thread.
  void end() noexcept;
  /// Closes the device and gives all slots back. Not beside run(), which does it at its end.
  void close() noexcept;
  DeviceStatus status() const;

 private:
  using Counter = std::atomic<std::uint64_t>;

  void tell(DeviceState state, const std::string& problem);
  void stream(FrameSink& sink) noexcept;
  void deliver(FrameSink& sink, V4l2Image& image) noexcept;
  void follow(FrameSink& sink, const V4l2Image& image) noexcept;
  void open_again(FrameSink& sink) noexcept;
  bool stopping() const noexcept { return stopping_.load(std::memory_order_acquire); }

  V4l2System& system_;
  const std::string path_;
  const V4l2Settings settings_;
  const std::uint32_t number_;
  Descriptor wake_;
  std::atomic<bool> stopping_{false};
  V4l2Loan loan_;  // outlives the device, which may write into its slots
  std::optional<V4l2Device> device_;
  ImageShape shape_;
  std::uint32_t bits_ = 8;
  std::int64_t period_ns_ = 0;
  FrameCounter counter_{FrameCounter::Width::bits32};
  std::uint64_t index_ = 0;
  std::uint32_t sequence_ = 0;
  std::int64_t last_time_ns_ = 0;
  bool resumed_ = false;
  Counter sessions_{0}, dequeued_{0}, torn_{0}, no_slot_{0}, gaps_{0}, backwards_{0}, lost_{0}, changed_{0}, came_{0};
  mutable std::mutex status_lock_;  // taken when a device comes or goes, never per frame
  DeviceStatus status_;
};

}  // namespace rptv
