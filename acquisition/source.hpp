// SPDX-License-Identifier: MIT
// The seam that frames come through: cameras, recordings and simulations implement Source and fill a FrameSink.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/device_status.hpp"
#include "core/frame.hpp"
#include "core/losses.hpp"

namespace rptv {

struct CameraInfo {
  std::string name;  ///< what the user calls it; unique within a source
  ImageShape shape;
  std::uint32_t significant_bits = 8;  ///< grey values lie in 0 … 2^bits − 1
  std::size_t bytes_behind_image = 0;  ///< that the source needs in each slot
};

/// Where a source puts its frames. Per camera, one thread at a time calls these; different cameras may use different
/// threads. All are noexcept, allocate nothing and take no lock.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// A slot for the next frame of `camera`. Under policy `lossless` this waits for one (until the sink is closed); else
  /// an empty lease means that none is free: skip the frame, the sink has counted it.
  virtual FrameLease claim(std::uint32_t camera) noexcept = 0;
  /// Hands over a filled frame. The sink checks indices (gap, duplicate), torn flags, and counts what it drops.
  virtual void deliver(Frame&& frame) noexcept = 0;
  /// The source itself knows of a loss that the sink cannot see.
  virtual void lose(std::uint32_t camera, LossCause cause, std::uint64_t count) noexcept = 0;
  /// No more frames will come from any camera (end of a recording).
  virtual void end() noexcept = 0;
};

/// A set of 1 to kMaxCameras cameras. Set-up throws Error; after start() frames flow on the source's own threads.
class Source {
 public:
  virtual ~Source() = default;
  /// Known after construction, in camera order.
  virtual const std::vector<CameraInfo>& cameras() const noexcept = 0;
  /// Begins to deliver. `sink` must live until stop() has returned. Called once, from the main thread.
  virtual void start(FrameSink& sink) = 0;
  /// Returns when no thread of the source will touch the sink again. Idempotent; main thread.
  virtual void stop() noexcept = 0;
  /// Duration between frames that the source was configured for, ns; 0 when it is not known.
  virtual std::int64_t nominal_period_ns() const noexcept = 0;
  /// What went wrong for good since start() (a file that vanished), one line; empty while all is well. Any thread.
  virtual std::string failure() const = 0;
  /// Per camera, in camera order: how the device and its driver fare. Empty for sources without devices. Any thread but
  /// a real-time one: it may allocate and take a lock.
  virtual std::vector<DeviceStatus> device_status() const { return {}; }
};

}  // namespace rptv
