// SPDX-License-Identifier: MIT
// Rigs from OpenPTV's calibration files and back, in liboptv's meaning of every number.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibration/cameras/openptv_files.hpp"
#include "calibration/cameras/rig.hpp"

namespace rptv {

/// What `scx` of .addpar scales: liboptv took it as the aspect of the pixels until March 2025, and as a factor of both
/// axes since.
enum class OpenptvScale { columns, both };

/// The model that projects as liboptv's img_coord() and metric_to_pixel() do, half a pixel less: its pixel centres are
/// at halves. Throws Error(configuration) behind `origin`.
CameraModel from_openptv(const OpenptvCamera& camera, const OpenptvSetup& setup, OpenptvScale scale,
                         const std::string& origin);

/// A rig, and what a user should look at, one line each.
struct OpenptvImport {
  Rig rig;
  std::vector<std::string> warnings;
};

/// Reads a ptv.par (or the folder that holds it, or whose `parameters` does) and the .ori and .addpar beside the
/// calibration images that it names, relative to the folder above it or its own. Cameras are called like those images.
/// Throws Error (no_input, bad_data, configuration) with file, line and value.
OpenptvImport import_openptv(const std::filesystem::path& place, OpenptvScale scale = OpenptvScale::columns);

/// One camera's files for OpenPTV.
struct OpenptvExport {
  OpenptvCamera camera;
  double worst_px = 0;  ///< largest difference of the projections within the image; not 0 where OpenPTV's distortion
                        ///< about the image's centre had to stand in for one about another place
};

/// The inverse of from_openptv(); OpenPTV counts in mm, so any `pixel_mm` will do. `setup` gets size, pixels and media.
/// Throws Error(configuration) for interfaces that OpenPTV has no words for: more than glass, or not before the origin.
OpenptvExport to_openptv(const CameraModel& model, double pixel_mm, OpenptvSetup& setup, const std::string& origin);

/// Writes parameters/ptv.par, cal/NAME.tif.ori and cal/NAME.tif.addpar below `folder`, and returns worst_px per camera.
/// Throws Error (configuration, io), also when the cameras differ in image size or media, which ptv.par has once.
std::vector<double> export_openptv(const Rig& rig, double pixel_mm, const std::filesystem::path& folder,
                                   const std::string& origin);

}  // namespace rptv
