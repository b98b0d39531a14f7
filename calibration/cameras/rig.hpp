// SPDX-License-Identifier: MIT
// The cameras of a multi-view rig in one frame, and the TOML file that holds them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/cameras/camera_model.hpp"

namespace rptv {

/// A camera and what frames call it.
struct RigCamera {
  std::string name;
  CameraModel model;
};

/// Cameras with one frame of coordinates, mm. Plain values; reading and writing are set-up.
struct Rig {
  static constexpr std::int64_t kSchema = 1;
  static constexpr std::size_t kMostCameras = 16;
  std::vector<RigCamera> cameras;  ///< 1 to kMostCameras, names differ
};

/// Reads a rig file: sections camera_1 to camera_16 (docs/calibration.md). Throws Error (no_input, configuration) with
/// the file, the key or camera, the value and the next step.
Rig read_rig(const std::filesystem::path& file);

/// The same from TOML text; `origin` stands for the file's name in messages.
Rig parse_rig(std::string_view text, const std::string& origin);

/// The rig as TOML text; parse_rig() of it gives every number back bit for bit.
std::string to_toml(const Rig& rig);

/// to_toml() into a file. Throws Error(io).
void write_rig(const Rig& rig, const std::filesystem::path& file);

/// Throws Error(configuration) when images of width x height px cannot be of this camera. `origin` is the rig's file.
void check_resolution(const RigCamera& camera, int width_px, int height_px, const std::string& origin);

}  // namespace rptv
