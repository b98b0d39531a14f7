// SPDX-License-Identifier: MIT
// `rapidptv calibrate import` and `export`: rigs from other programs' calibrations, and for them.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "calibration/cameras/opencv_yaml.hpp"
#include "calibration/cameras/openptv.hpp"
#include "core/json.hpp"
#include "daemon/commands/calibrate.hpp"

namespace rptv {
namespace {

struct Options {
  std::vector<std::string> files;
  std::string place, scale = "columns", output;
  double unit_mm = 1, pixel_um = 10;
  bool json = false;
};

std::string line_of(const RigCamera& camera) {
  const auto& lens = camera.model.intrinsics();
  const Point3& at = camera.model.centre_mm();
  return fmt::format("{:<12} {}x{} px, focal length {:.2f} px, at {:.2f}, {:.2f}, {:.2f} mm, {} interfaces\n",
                     camera.name, lens.width_px, lens.height_px, lens.fx_px, at[0], at[1], at[2],
                     camera.model.stack().interfaces.size());
}

std::string json_of(const RigCamera& camera) {
  const auto& lens = camera.model.intrinsics();
  const Point3& at = camera.model.centre_mm();
  return fmt::format(R"({{"name":{},"width_px":{},"height_px":{},"fx_px":{},"centre_mm":[{},{},{}],"interfaces":{}}})",
                     json_string(camera.name), lens.width_px, lens.height_px, json_number(lens.fx_px),
                     json_number(at[0]), json_number(at[1]), json_number(at[2]),
                     camera.model.stack().interfaces.size());
}

ExitCode keep(const OpenptvImport& import, const Options& options) {
  write_rig(import.rig, options.output);
  std::string text;
  for (const RigCamera& camera : import.rig.cameras)
    text += options.json ? (text.empty() ? "" : ",") + json_of(camera) : line_of(camera);
  std::cout << (options.json ? "{\"cameras\":[" + text + "]}\n" : text);
  for (const std::string& warning : import.warnings) std::cerr << "warning: " << warning << '\n';
  std::cerr << "wrote " << options.output << '\n';
  return ExitCode::ok;
}

ExitCode from_openptv(const Options& options) {
  return keep(import_openptv(options.place, options.scale == "both" ? OpenptvScale::both : OpenptvScale::columns),
              options);
}

ExitCode from_opencv(const Options& options) {
  return keep({import_opencv({options.files.begin(), options.files.end()}, options.unit_mm), {}}, options);
}

ExitCode to_openptv(const Options& options) {
  const Rig rig = read_rig(options.place);
  const auto worst_px = export_openptv(rig, 1e-3 * options.pixel_um, options.output, options.place);
  std::string text;
  for (std::size_t i = 0; i < worst_px.size(); ++i)
    text += options.json
                ? fmt::format(R"({}{{"name":{},"worst_px":{}}})", i == 0 ? "" : ",", json_string(rig.cameras[i].name),
                              json_number(worst_px[i]))
                : fmt::format("{:<12} projects within {:.2g} px of the rig\n", rig.cameras[i].name, worst_px[i]);
  std::cout << (options.json ? "{\"cameras\":[" + text + "]}\n" : text);
  for (std::size_t i = 0; i < worst_px.size(); ++i)
    if (worst_px[i] > 0.05)
      std::cerr << fmt::format(
          "warning: {}: OpenPTV's distortion is about the image's centre, this camera's is not, and the nearest is "
          "{:.2g} px "
          "off in a corner\n",
          rig.cameras[i].name, worst_px[i]);
  std::cerr << fmt::format("wrote {0}/parameters/ptv.par and {0}/cal\n", options.output);
  return ExitCode::ok;
}

/// A subcommand that ends in `action`, with the options that all three have.
Command add(Command parent, const char* name, const char* what, const char* output, Action& chosen,
            const std::shared_ptr<Options>& options, ExitCode (*action)(const Options&)) {
  Command command = parent.add_subcommand(name, what);
  command.add_option("-o,--output", options->output, output).required();
  command.add_flag("--json", options->json, "print the cameras as one JSON object");
  command.callback([=, &chosen] { chosen = [=] { return action(*options); }; });
  return command;
}

}  // namespace

void add_calibrate_import(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command import = calibrate.add_subcommand("import", "A rig from OpenPTV's or OpenCV's calibration files");
  import.require_subcommand();
  Command openptv =
      add(import, "openptv", "ptv.par, .ori and .addpar", "rig file (TOML) to write", chosen, options, from_openptv);
  openptv.add_option("place", options->place, "ptv.par, or OpenPTV's working folder with parameters/ and cal/")
      .required();
  openptv.add_option("--scale", options->scale, "what scx scales: the columns (liboptv until March 2025), or both axes")
      .one_of({"columns", "both"});
  openptv.footer("Example:\n  rapidptv calibrate import openptv test_cavity -o rig.toml");
  Command opencv = add(import, "opencv", "YAML, XML or JSON, one file per camera", "rig file (TOML) to write", chosen,
                       options, from_opencv);
  opencv.add_option("files", options->files, "one per camera; cameras are called like their files").required();
  opencv.add_option("--unit-mm", options->unit_mm, "mm in one unit of T: 1000 when it is in metres").range(1e-9, 1e9);
  opencv.footer("Example:\n  rapidptv calibrate import opencv left.yml right.yml --unit-mm 1000 -o rig.toml");
  import.footer(
      "Examples:\n"
      "  rapidptv calibrate import openptv test_cavity -o rig.toml\n"
      "  rapidptv calibrate import opencv left.yml right.yml --unit-mm 1000 -o rig.toml");
}

void add_calibrate_export(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command command = calibrate.add_subcommand("export", "A rig as OpenPTV's calibration files");
  command.require_subcommand();
  Command openptv =
      add(command, "openptv", "ptv.par, .ori and .addpar", "folder to write", chosen, options, to_openptv);
  openptv.add_option("rig", options->place, "rig file (TOML)").required();
  openptv
      .add_option("--pixel-um", options->pixel_um,
                  "pixel pitch that OpenPTV's mm count from; projections do not depend on it")
      .range(1e-3, 1e6);
  for (Command app : {command, openptv})
    app.footer("Example:\n  rapidptv calibrate export openptv rig.toml --pixel-um 12 -o test_cavity");
}

}  // namespace rptv
