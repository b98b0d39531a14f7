// SPDX-License-Identifier: MIT
// `rapidptv calibrate points`: cameras fitted to points whose places are known.
#include <fmt/format.h>

#include <iostream>

#include "calibration/cameras/known_points.hpp"
#include "core/json.hpp"
#include "daemon/commands/calibrate.hpp"

namespace rptv {
namespace {

struct Options {
  std::string points, start, fit = "focal", output;
  bool json = false;
};

CameraFreedom freedom_of(const std::string& fit) {
  if (fit == "pose") return CameraFreedom::pose;
  return fit == "focal" ? CameraFreedom::focal : CameraFreedom::distortion;
}

std::string line_of(const std::string& name, const KnownPointsCamera& camera) {
  if (camera.points == 0) return fmt::format("{:<12} no points: as it was\n", name);
  return fmt::format("{:<12} {} points, {} left out; rms {:.4f} px before, {:.4f} px after, largest {:.4f} px\n", name,
                     camera.points, camera.left_out, camera.before_rms_px, camera.rms_px, camera.worst_px);
}

std::string json_of(const std::string& name, const KnownPointsCamera& camera) {
  return fmt::format(R"({{"name":{},"points":{},"left_out":{},"before_rms_px":{},"rms_px":{},"worst_px":{}}})",
                     json_string(name), camera.points, camera.left_out, json_number(camera.before_rms_px),
                     json_number(camera.rms_px), json_number(camera.worst_px));
}

ExitCode run(const Options& options) {
  const Rig start = read_rig(options.start);
  const auto fit =
      fit_known_points(start, read_known_points(options.points, start), freedom_of(options.fit), options.points);
  write_rig(fit.rig, options.output);
  std::string text;
  for (std::size_t k = 0; k < fit.cameras.size(); ++k) {
    const std::string& name = fit.rig.cameras[k].name;
    text += options.json ? (k == 0 ? "" : ",") + json_of(name, fit.cameras[k]) : line_of(name, fit.cameras[k]);
  }
  std::cout << (options.json ? "{\"cameras\":[" + text + "]}\n" : text);
  std::cerr << "wrote " << options.output << '\n';
  return ExitCode::ok;
}

}  // namespace

void add_calibrate_points(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command command = calibrate.add_subcommand("points", "Cameras of a rig from points whose places are known");
  command.add_option("points", options->points, "table (CSV) of points and where cameras see them; - is standard input")
      .required();
  command.add_option("--start", options->start, "rig file (TOML) to start from: within some degrees and centimetres")
      .required();
  command
      .add_option("--fit", options->fit,
                  "what is fitted: pose; focal: and the focal length; distortion: and k1, p1, p2")
      .one_of({"pose", "focal", "distortion"});
  command.add_option("-o,--output", options->output, "rig file (TOML) to write").required();
  command.add_flag("--json", options->json, "print the residuals as one JSON object");
  command.footer(
      "Columns: camera,x,y,z,column,row (the camera's name; mm in the rig's frame; px, pixel centres are integers). "
      "The walls\n"
      "between camera and points are those of the start. Points at more than one depth tell the focal length.\n\n"
      "Example:\n"
      "  rapidptv calibrate points dots.csv --start rig.toml --fit distortion -o fitted.toml");
  command.callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rptv
