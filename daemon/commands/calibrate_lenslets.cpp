// SPDX-License-Identifier: MIT
// `rapidptv calibrate lenslets`: images of the lenslet array in, calibration, arrays, figures and a report out.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "calibration/light_field/calibrate_lenslets.hpp"
#include "calibration/light_field/calibration_figures.hpp"
#include "calibration/light_field/lenslet_report.hpp"
#include "daemon/commands/calibrate.hpp"
#include "daemon/progress.hpp"
#include "replay/colour_png.hpp"
#include "replay/image_sequence.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> images, dark, set;
  std::string start, shape;
  std::string output;
  double pixel_um = 0, pitch_um = 0, focal_mm = 0, f_number = 0, exit_pupil_mm = -1;
  bool particles = false, fit_exit_pupil = false, json = false;
};

ImageSequence open_images(const std::vector<std::string>& paths) {
  if (paths.size() > 1 || !fs::is_directory(paths.front())) return {"images", {paths.begin(), paths.end()}};
  auto cameras = open_cameras(paths.front());
  if (cameras.size() != 1)
    throw Error(ExitCode::usage,
                fmt::format("{}: has {} cameras; name one camera's folder", paths.front(), cameras.size()));
  return std::move(cameras.front());
}

ImageStatistics read_images(const ImageSequence& sequence, const std::string& what) {
  ImageStatistics statistics;
  ImageSequence::Reader reader(sequence);
  std::vector<std::byte> pixels(sequence.shape().bytes());
  Progress progress(what, sequence.size());
  for (std::size_t i = 0; i < sequence.size(); ++i, progress.advance()) {
    reader.decode(i, pixels);
    statistics.add({pixels.data(), sequence.shape()}, sequence.file(i).string());
  }
  return statistics;
}

struct Start {
  LightFieldCalibration calibration;
  LensletKnowledge known;
};

/// The data sheet: the file, then the options; what no image can tell must be there.
Start read_start(const Options& options, const ImageShape& shape) {
  Start start;
  auto& c = start.calibration;
  c.lens.exit_pupil_mm = -1;  // not given
  FieldList list;
  c.fields(list);
  list.require_nothing();
  if (!options.start.empty())
    read_toml_file(options.start, "light-field calibration", LightFieldCalibration::kSchema, list);
  for (const auto& assignment : options.set) set_field(list, assignment);
  if (options.pixel_um > 0) c.sensor.pixel_um = options.pixel_um;
  if (options.pitch_um > 0) c.lenslets.pitch_um = options.pitch_um;
  if (options.focal_mm > 0) c.lenslets.focal_length_mm = options.focal_mm;
  if (options.f_number > 0) c.lens.image_f_number = options.f_number;
  if (!options.shape.empty()) c.lenslets.shape = options.shape;
  if (options.exit_pupil_mm >= 0) c.lens.exit_pupil_mm = options.exit_pupil_mm;
  if (options.fit_exit_pupil) c.lens.exit_pupil_mm = -1;
  const auto need = [](bool given, const char* what) {
    if (!given) throw Error(ExitCode::usage, fmt::format("{}, or a --start file with it", what));
  };
  need(c.sensor.pixel_um > 0, "the pixel's size is missing; give --pixel-um");
  need(c.lenslets.pitch_um > 0, "the array's pitch is missing; give --pitch-um");
  need(c.lenslets.focal_length_mm > 0, "the lenslets' focal length is missing; give --focal-mm");
  need(!c.lens.model.empty(),
       "the main lens is missing; give --set lens.model=thick_lens (and lens.focal_length_mm, "
       "lens.array_distance_mm) or telecentric (and lens.magnification)");
  if (c.sensor.width_px == 0) c.sensor.width_px = shape.width_px, c.sensor.height_px = shape.height_px;
  if (c.sensor.width_px != shape.width_px || c.sensor.height_px != shape.height_px)
    throw Error(ExitCode::configuration,
                fmt::format("{}: is for {}x{} px and the images have {}x{}; use the same region of interest",
                            options.start, c.sensor.width_px, c.sensor.height_px, shape.width_px, shape.height_px));
  if (c.lens.exit_pupil_mm < 0 && c.lens.model == "telecentric" && !options.fit_exit_pupil) c.lens.exit_pupil_mm = 0;
  start.known.exit_pupil_known = c.lens.exit_pupil_mm >= 0;
  if (!start.known.exit_pupil_known) c.lens.exit_pupil_mm = 0;
  c.lenslets.rotation_deg = 0, c.lenslets.offset_um = {0, 0};
  c.lenslets.distortion_x_um.clear(), c.lenslets.distortion_y_um.clear();
  c.validate(options.start.empty() ? "command line" : options.start);
  return start;
}

fs::path beside(const fs::path& output, const std::string& suffix) {
  return output.parent_path() / (output.stem().string() + suffix);
}

ExitCode run(const Options& options) {
  const ImageSequence sequence = open_images(options.images);
  const auto [start, known] = read_start(options, sequence.shape());
  LensletImages images;
  images.origin = sequence.size() == 1 ? sequence.file(0).string() : options.images.front() + " and the others";
  images.particle_images = options.particles, images.significant_bits = sequence.significant_bits();
  images.images = read_images(sequence, "reading images");
  if (!options.dark.empty()) images.dark = read_images(open_images(options.dark), "reading dark images");
  auto result = calibrate_lenslets(images, start, known);
  result.calibration.lenslets.arrays = beside(options.output, ".h5").filename().string();
  write_calibration_arrays(result.arrays, beside(options.output, ".h5"));
  write_light_field_calibration(result.calibration, options.output);
  const GreyImage grey = options.particles ? images.images.maximum() : images.images.mean();
  const double enlargement =
      residual_enlargement(result.found, result.found.fit.lattice.pitch_mm / result.calibration.pixel_mm());
  write_colour_png(beside(options.output, "_centres.png"), draw_centres(grey, result.found));
  write_colour_png(beside(options.output, "_residuals.png"), draw_residuals(grey, result.found, enlargement));
  std::cout << (options.json ? to_json(result) + "\n" : to_text(result));
  for (const auto& warning : result.calibration.warnings()) std::cerr << "warning: " << warning << '\n';
  std::cerr << fmt::format("wrote {}, {}, {} and {} (arrows {:g} times the residuals)\n", options.output,
                           beside(options.output, ".h5").string(), beside(options.output, "_centres.png").string(),
                           beside(options.output, "_residuals.png").string(), enlargement);
  return ExitCode::ok;
}

}  // namespace

void add_calibrate_lenslets(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command command =
      calibrate.add_subcommand("lenslets", "Lenslet lattice, exit pupil, mask and vignetting from images");
  command.add_option("images", options->images, "white image(s), averaged; or with --particles many particle images")
      .required();
  command.add_flag("--particles", options->particles,
                   "the images are of particles: no white image and no touch of the lens");
  command.add_option("--dark", options->dark, "dark image(s): black level and noise");
  command.add_option("--start", options->start, "data sheet and lens as a (partial) calibration file (TOML)");
  command.add_option("--set", options->set, "override one value of it: key=value").allow_extra_args(false);
  command.add_option("--pixel-um", options->pixel_um, "pixel pitch").range(1e-6, 1e9);
  command.add_option("--pitch-um", options->pitch_um, "the array's pitch by its data sheet").range(1e-6, 1e9);
  command.add_option("--focal-mm", options->focal_mm, "the lenslets' focal length").range(1e-6, 1e9);
  command.add_option("--shape", options->shape, "arrangement").one_of({"square", "hexagonal"});
  command.add_option("--f-number", options->f_number, "f-number of the cone that reaches the array").range(1e-6, 1e9);
  command
      .add_option("--exit-pupil-mm", options->exit_pupil_mm, "exit pupil before the array, if known (0: telecentric)")
      .range(0.0, 1e7);
  command
      .add_flag("--fit-exit-pupil", options->fit_exit_pupil,
                "fit it from the pitch although --start or the lens tells it")
      .excludes("--exit-pupil-mm");
  command.add_option("-o,--output", options->output, "calibration file (TOML); arrays and figures go beside it")
      .required();
  command.add_flag("--json", options->json, "print the report as one JSON object");
  command.footer(
      "With the exit pupil given (or a telecentric lens) the pitch is fitted; else the exit pupil is, from the pitch.\n"
      "docs/calibration.md says how to take the images.\n\n"
      "Examples:\n"
      "  rapidptv calibrate lenslets white.png --dark dark.png --start sheet.toml -o cal.toml\n"
      "  rapidptv calibrate lenslets white.png --pixel-um 4.35 --pitch-um 125 --focal-mm 3.75 --set "
      "lens.model=telecentric \\\n"
      "      --set lens.magnification=20 -o cal.toml\n"
      "  rapidptv calibrate lenslets --particles frames/ --start sheet.toml -o cal.toml");
  command.callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rptv
