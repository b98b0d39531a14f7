// SPDX-License-Identifier: MIT
// `rapidptv info`: what this build is, and what a given file holds.
#include <fmt/format.h>
#include <zmq.h>

#include <algorithm>
#include <iostream>
#include <set>
#include <thread>

#include "calibration/light_field/light_field_calibration.hpp"
#include "daemon/commands/command.hpp"
#include "proto/wire.hpp"
#include "replay/image_file.hpp"
#include "simulation/lens_analysis.hpp"
#include "simulation/shipped_file.hpp"
#include "simulation/truth.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

struct InfoOptions {
  std::vector<fs::path> files;
  bool lenses = false;
};

void describe_build() {
  int major = 0, minor = 0, patch = 0;
  zmq_version(&major, &minor, &patch);
  std::cout << fmt::format(
      "rapidptv {}, wire schema {}, compiled by {}\nZeroMQ {}.{}.{}, {} processors, reconstruction backends: cpu\n",
      RPTV_VERSION, kWireSchema, __VERSION__, major, minor, patch, std::thread::hardware_concurrency());
}

void describe_image(const fs::path& file) {
  const auto reader = open_image(file);
  const ImageHeader& header = reader->header(0);
  std::cout << fmt::format("{}: {} × {} px, {} bit in {}, {} image{}\n", file.string(), header.shape.width_px,
                           header.shape.height_px, header.significant_bits, 8 * header.shape.bytes_per_pixel,
                           reader->pages(), reader->pages() == 1 ? "" : "s");
}

void describe_folder(const fs::path& folder) {
  std::set<fs::path> images;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string ending = entry.path().extension().string();
    if (ending == ".png" || ending == ".tif" || ending == ".tiff") images.insert(entry.path());
  }
  if (images.empty())
    throw Error(ExitCode::no_input, folder.string() + ": no PNG or TIFF image in it; name the folder that has them");
  std::cout << fmt::format("{}: {} images, first and last by name:\n", folder.string(), images.size());
  describe_image(*images.begin());
  describe_image(*images.rbegin());
}

void describe_table(const fs::path& file) {
  const Measurement table = read_measurement(file);
  std::set<std::uint64_t> frames, particles;
  for (const TrackRow& row : table.rows) {
    frames.insert(row.frame);
    particles.insert(row.particle);
  }
  std::cout << fmt::format("{}: {} of {} points in {} frames", file.string(), table.linked ? "tracks" : "points",
                           table.rows.size(), frames.size());
  if (!frames.empty()) std::cout << fmt::format(" ({} to {})", *frames.begin(), *frames.rbegin());
  if (table.linked) std::cout << fmt::format(", {} tracks", particles.size());
  std::cout << '\n';
}

void describe_calibration(const fs::path& file) {
  const LightFieldCalibration calibration = read_light_field_calibration(file);
  std::cout << fmt::format(
      "{}: light-field calibration, {} × {} px of {} µm, lenslets {} µm with f {} mm, {} lens, magnification {:.4g}\n",
      file.string(), calibration.sensor.width_px, calibration.sensor.height_px, calibration.sensor.pixel_um,
      calibration.lenslets.pitch_um, calibration.lenslets.focal_length_mm, calibration.lens.model,
      calibration.magnification());
  for (const std::string& warning : calibration.warnings()) std::cout << "  " << warning << '\n';
}

void describe_prescription(const fs::path& file) {
  std::cout << file.string() << ": " << describe_lens(read_prescription(file), 0, 0);
}

void describe_installed_lenses() {
  for (const std::string& name : shipped_names("prescriptions"))
    describe_prescription(find_shipped("prescriptions", name));
}

void describe(const fs::path& file) {
  if (!fs::exists(file)) throw Error(ExitCode::no_input, file.string() + ": no such file or folder; check the path");
  const std::string ending = file.extension().string();
  if (fs::is_directory(file))
    describe_folder(file);
  else if (ending == ".csv")
    describe_table(file);
  else if (ending == ".toml" && is_prescription(file))
    describe_prescription(file);
  else if (ending == ".toml")
    describe_calibration(file);
  else
    describe_image(file);
}

}  // namespace

void add_info(Command app, Action& chosen) {
  auto options = std::make_shared<InfoOptions>();
  Command command = app.add_subcommand("info", "Say what this build is, or what files hold");
  command.add_option("files", options->files,
                     "images, folders of images, points or tracks (CSV), calibrations or lens prescriptions (TOML)");
  command.add_flag("--lenses", options->lenses, "describe the lens prescriptions that are installed");
  command.footer(
      "Examples:\n"
      "  rapidptv info\n"
      "  rapidptv info recording/ tracks.csv calibration.toml\n"
      "  rapidptv info --lenses\n"
      "  rapidptv info my_lens.toml");
  command.callback([options, &chosen] {
    chosen = [options] {
      if (options->lenses)
        describe_installed_lenses();
      else if (options->files.empty())
        describe_build();
      std::for_each(options->files.begin(), options->files.end(), describe);
      return ExitCode::ok;
    };
  });
}

}  // namespace rptv
