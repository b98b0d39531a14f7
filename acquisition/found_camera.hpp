// SPDX-License-Identifier: MIT
// Cameras that answer on this machine and its networks, for `rapidptv cameras`.
#pragma once

#include <string>
#include <vector>

#include "acquisition/v4l2_system.hpp"

namespace rptv {

struct FoundCamera {
  std::string bus;      ///< "GigEVision", "USB3Vision", "V4L2"
  std::string address;  ///< what the configuration names it by: aravis.cameras or v4l2.devices
  std::string vendor, model, serial;
  std::vector<std::string> formats;  ///< pixel formats, as the camera or driver calls them
  std::string problem;               ///< why the formats are not known; empty while all is well
};

/// GenICam cameras. Waits a second for answers, and up to 3 s more for each that is slow to open. Main thread.
std::vector<FoundCamera> find_aravis_cameras();

/// Capture devices of the kernel, in the order of their numbers. Main thread.
std::vector<FoundCamera> find_v4l2_cameras(V4l2System& system);

}  // namespace rptv
