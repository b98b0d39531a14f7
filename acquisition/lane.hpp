// SPDX-License-Identifier: MIT
// What the Intake keeps for one camera: its slots, its queue, its counters. Private to the Intake.
#pragma once

#include "acquisition/device_clock.hpp"
#include "acquisition/intake.hpp"
#include "core/frame_pool.hpp"

namespace rptv {

/// Shared by the camera's thread and the consumer (one camera) or the bundling thread (several).
struct Intake::Lane {
  Lane(const CameraInfo& camera, const IntakeOptions& options, const HandOverPolicy& policy);
  const ImageShape shape;
  FramePool pool;
  Losses losses;
  HandOver<Frame> queue;
  const std::size_t depth;
  std::atomic<std::uint64_t> delivered{0};
  std::atomic<std::uint64_t> queued{0};  // pushes begun
  std::uint64_t last_index = 0;          // camera's thread only, as the next two
  std::uint64_t excused = 0;             // frames since the last delivered one whose loss is counted already
  bool started = false;
  DeviceClock clock;        // map(): camera's thread only
  std::uint64_t taken = 0;  // bundling thread only, as the next two
  bool ended = false;
  bool silent = false;
};

}  // namespace rptv
