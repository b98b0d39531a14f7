// SPDX-License-Identifier: MIT
// Says when a camera has given no frame for too long, and why that probably is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/device_status.hpp"

namespace rptv {

/// One thread, which may allocate; not on the frames' path.
class SilenceAlarm {
 public:
  /// `names` in camera order; `limit_ns`: silence that is still in order.
  SilenceAlarm(std::vector<std::string> names, std::int64_t limit_ns);

  /// Compares the count of frames delivered so far with that of the last look. Returns a line for the log when an
  /// episode of silence begins or ends, else an empty text. The first look starts the clock. `device` may be null: the
  /// source has none.
  std::string look(std::uint32_t camera, std::int64_t now_ns, std::uint64_t delivered, const DeviceStatus* device);

  /// The warning while the camera is silent, with its cause as it is now; else empty.
  const std::string& warning(std::uint32_t camera) const noexcept { return cameras_[camera].warning; }

 private:
  struct Camera {
    std::string name, warning;
    bool seen = false;
    std::uint64_t delivered = 0;
    std::uint64_t missing = 0;  // packets, by the driver's count when the last frame came
    std::int64_t last_frame_ns = 0;
  };
  std::vector<Camera> cameras_;
  std::int64_t limit_ns_;
};

}  // namespace rptv
