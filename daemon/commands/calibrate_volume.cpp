// SPDX-License-Identifier: MIT
// `rapidptv calibrate volume`: points known in image and object space in, a fitted map in the calibration out.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "calibration/light_field/fit_volume.hpp"
#include "core/json.hpp"
#include "daemon/commands/calibrate.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string pairs, calibration, output;
  bool json = false;
};

std::string line_of(const std::string& what, const Point3& rms) {
  return fmt::format("{:<18}rms x {:.5f} y {:.5f} z {:.5f} mm", what, rms[0], rms[1], rms[2]);
}

std::string json_of(const Point3& p) {
  return "[" + json_number(p[0]) + "," + json_number(p[1]) + "," + json_number(p[2]) + "]";
}

ExitCode run(const Options& options) {
  const auto start = read_light_field_calibration(options.calibration);
  const auto pairs = read_correspondences(options.pairs);
  VolumeFit fit = fit_volume(pairs, start, options.pairs);
  const VolumeResiduals before = residuals_of(ObjectMap(start), pairs);
  if (auto& arrays = fit.calibration.lenslets.arrays; !arrays.empty())
    arrays =
        fs::proximate(fs::path(options.calibration).parent_path() / arrays, fs::absolute(options.output).parent_path())
            .string();
  write_light_field_calibration(fit.calibration, options.output);
  if (options.json) {
    std::cout << fmt::format(
        "{{\"points\":{},\"rms_mm\":{},\"left_out_rms_mm\":{},\"largest_mm\":{},\"condition\":{},"
        "\"before_rms_mm\":{}}}\n",
        pairs.size(), json_of(fit.residuals.rms), json_of(fit.left_out_rms), json_number(fit.residuals.largest),
        json_number(fit.condition), json_of(before.rms));
    return ExitCode::ok;
  }
  const auto& p = fit.calibration.polynomial;
  std::cout << fmt::format("points            {}, condition {:.3g}\n", pairs.size(), fit.condition)
            << line_of(start.lens.model, before.rms) << fmt::format(" (before), largest {:.5f} mm\n", before.largest)
            << line_of("polynomial", fit.residuals.rms)
            << fmt::format(", largest {:.5f} mm (point {})\n", fit.residuals.largest, fit.residuals.worst + 1)
            << line_of("left-out points", fit.left_out_rms) << '\n'
            << fmt::format(
                   "valid in          object space x {:.3g} to {:.3g}, y {:.3g} to {:.3g}, z {:.3g} to {:.3g} mm\n",
                   p.from_mm[0], p.to_mm[0], p.from_mm[1], p.to_mm[1], p.from_mm[2], p.to_mm[2]);
  std::cerr << "wrote " << options.output << '\n';
  return ExitCode::ok;
}

}  // namespace

void add_calibrate_volume(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command command = calibrate.add_subcommand("volume", "Map from image to object space through known points");
  command.add_option("pairs", options->pairs, "table (CSV) of points in both spaces; - is standard input").required();
  command.add_option("--calibration", options->calibration, "light-field calibration (TOML) to complete").required();
  command.add_option("-o,--output", options->output, "the same with lens.model = \"polynomial\" (TOML)").required();
  command.add_flag("--json", options->json, "print the residuals as one JSON object");
  command.footer(
      "Columns: image_x,image_y,image_z,object_x,object_y,object_z (mm; image space as `reconstruct --space image` "
      "gives\n"
      "it, object space with z towards the lens). At least 25 points on 3 depths with 4 rows and columns each.\n"
      "The polynomial (Soloff, Adrian and Liu 1997: third order in x and y, second in z) replaces eq. (8)-(9) or "
      "(11).\n\n"
      "Examples:\n"
      "  rapidptv calibrate volume target.csv --calibration cal.toml -o volume.toml\n"
      "  rapidptv reconstruct frames/ --calibration volume.toml -o points.csv");
  command.callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rptv
