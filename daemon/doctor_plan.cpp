// SPDX-License-Identifier: MIT
// Sizes, rates and folders out of a configuration.
#include "daemon/doctor_plan.hpp"

#include <algorithm>

#include "acquisition/pixel_format.hpp"
#include "core/error.hpp"
#include "daemon/session.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

constexpr double kBytesPerCell = 20;  // of a table: a number of 17 digits, its sign, point and comma
constexpr double kPointCells = 13, kTrackCells = 11, kEstimateCells = 21;

bool is_file(const std::string& output) { return !output.empty() && output != "-"; }

/// As the configuration names them.
std::vector<CameraLoad> cameras_of(const Config& config) {
  std::vector<CameraLoad> cameras;
  if (config.source.kind == "aravis")
    for (const std::string& name : config.aravis.cameras) cameras.push_back({name});
  if (config.source.kind == "v4l2")
    for (const std::string& name : config.v4l2.devices) cameras.push_back({name});
  return cameras;
}

double bytes_on_the_wire(const Config& config, const ImageShape& shape) {
  const PixelFormat* format = config.source.kind == "aravis" ? find_pixel_format(config.aravis.pixel_format) : nullptr;
  const std::size_t pixels = std::size_t{shape.width_px} * shape.height_px;
  return static_cast<double>(format != nullptr ? format->payload_bytes(pixels) : shape.bytes());
}

double bytes_written_per_frame(const Config& config) {
  double bytes = 0;
  if (is_file(config.output.points)) bytes += kPointCells * kBytesPerCell * static_cast<double>(config.max_particles());
  const double track_cells = kTrackCells + (config.linker.filters() ? kEstimateCells : 0);
  if (is_file(config.output.tracks)) bytes += track_cells * kBytesPerCell * static_cast<double>(config.max_particles());
  return bytes;
}

}  // namespace

DoctorPlan plan_of(const Config& config) {
  DoctorPlan plan;
  plan.cameras = cameras_of(config);
  for (const std::string& file : {config.output.tracks, config.output.points}) {
    if (!is_file(file)) continue;
    const fs::path folder = fs::absolute(file).parent_path();
    auto& all = plan.output_folders;
    if (std::find(all.begin(), all.end(), folder) == all.end()) all.push_back(folder);
  }
  try {
    const auto source = make_source(config);
    const auto period_ns = static_cast<double>(source->nominal_period_ns());
    if (period_ns <= 0) return plan;
    plan.output_bytes_per_second = bytes_written_per_frame(config) * 1e9 / period_ns;
    for (std::size_t i = 0; i < plan.cameras.size(); ++i)
      plan.cameras[i].bytes_per_second = bytes_on_the_wire(config, source->cameras()[i].shape) * 1e9 / period_ns;
  } catch (const Error& error) {
    plan.findings.push_back({"source", Finding::Verdict::problem, error.what(), "frames", "mend this first"});
  }
  return plan;
}

}  // namespace rptv
