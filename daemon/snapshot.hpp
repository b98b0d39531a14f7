// SPDX-License-Identifier: MIT
// One image of each camera of a configuration, as a file, and what its grey values say about the exposure.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/source.hpp"
#include "daemon/config.hpp"

namespace rptv {

/// What one image amounts to.
struct Snapshot {
  CameraInfo camera;
  std::filesystem::path file;
  ClockId clock = ClockId::nominal;
  std::int64_t exposure_end_ns = 0;  ///< of `clock`
  std::uint32_t minimum = 0, maximum = 0;
  double mean = 0;
  double saturated = 0;  ///< share of the pixels at the greatest value, 0 … 1
  std::string link;      ///< the driver's account: format, exposure, packets; empty for a recording
};

/// Starts the configured source, takes the first whole image of each camera and writes it as PNG in its full depth.
/// `out`: a folder, or a file for a single camera, whose name gets "-CAMERA" before its ending where there are several;
/// empty: CAMERA.png here. Cameras need not be paired. Throws Error: what the source throws; unavailable when a camera
/// gives no image for `patience_ns`; io and permission from writing.
std::vector<Snapshot> take_snapshots(const Config& config, const std::filesystem::path& out, std::int64_t patience_ns);

/// One line for people, one JSON object for scripts.
std::string to_text(const Snapshot& snapshot);
std::string to_json(const Snapshot& snapshot);

}  // namespace rptv
