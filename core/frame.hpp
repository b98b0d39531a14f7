// SPDX-License-Identifier: MIT
// One image of one camera with its times, on its way through the pipeline; and the images of all cameras at one
// instant.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "core/clock.hpp"
#include "core/frame_pool.hpp"
#include "core/image.hpp"

namespace rptv {

inline constexpr std::size_t kMaxCameras = 16;

/// When and where a frame was taken.
struct FrameInfo {
  std::uint64_t index = 0;                ///< trigger index: equal in every camera for one instant; a jump is a loss
  std::uint32_t camera = 0;               ///< position in Source::cameras()
  ClockId clock = ClockId::nominal;       ///< the clock of exposure_end_ns
  std::int64_t exposure_end_ns = 0;       ///< physics: velocities come from differences of this, never from arrival
  std::int64_t exposure_end_host_ns = 0;  ///< the same instant mapped to CLOCK_MONOTONIC: latency counts from here
  std::int64_t arrival_ns = 0;            ///< CLOCK_MONOTONIC when the last byte was in the slot
  bool torn = false;                      ///< incomplete: do not reconstruct
};

/// Move-only. Pixels are contiguous rows in the leased slot.
struct Frame {
  FrameInfo info;
  ImageShape shape;
  FrameLease lease;

  ImageView view() const noexcept { return {lease ? lease.get() : nullptr, shape}; }
};

/// Frames of one instant, one per camera in camera order. Move-only.
struct FrameSet {
  std::array<Frame, kMaxCameras> frames;
  std::uint32_t cameras = 0;

  std::span<const Frame> all() const noexcept { return {frames.data(), cameras}; }
  const FrameInfo& info() const noexcept { return frames[0].info; }
  void reset() noexcept {
    for (auto& frame : frames) frame.lease.reset();
    cameras = 0;
  }
};

}  // namespace rptv
