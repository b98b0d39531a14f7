// SPDX-License-Identifier: MIT
// `rapidptv calibrate refine`: images of particles and a rig in, the rig put right by them out.
#include <fmt/format.h>

#include <iostream>

#include "calibration/cameras/camera_graph.hpp"
#include "calibration/space_algebra.hpp"
#include "core/json.hpp"
#include "daemon/commands/calibrate.hpp"
#include "daemon/refine_rig.hpp"

namespace rptv {
namespace {

constexpr double kMuch_px = 0.1;

struct Options {
  std::string images, start, config, output, fit = "pose";
  std::vector<std::string> set;
  std::vector<int> parts{4, 3, 2};
  RefineOptions refine;
  bool json = false;
};

Config resolve(const Options& options) {
  Config config =
      options.config.empty() ? parse_config("", "command line", options.set) : load_config(options.config, options.set);
  config.reconstruction.kind = "multi_view", config.multi_view.method = "detections";
  if (!options.images.empty()) config.replay.path = options.images;
  if (!options.start.empty()) config.multi_view.rig = options.start;
  if (config.replay.path.empty())
    throw Error(ExitCode::usage, "no images; name the folder of all cameras, or a --config whose replay.path does");
  if (config.multi_view.rig.empty())
    throw Error(ExitCode::usage, "no rig; give --start, or a --config whose multi_view.rig names one");
  return config;
}

/// How a camera was moved: its centre (mm) and its direction (degrees).
std::array<double, 2> move_of(const CameraModel& from, const CameraModel& to) {
  return {norm(to.centre_mm() - from.centre_mm()), angle_deg(to.pose().rotation * transpose(from.pose().rotation))};
}

std::string line_of(const std::string& name, const CameraDisparity& before, const CameraDisparity& after,
                    std::size_t parts, const std::array<double, 2>& move) {
  return fmt::format(
      "{:<12} disparity {:.3f} px before, {:.3f} px after; worst {:.3f} px near ({:.4g}, {:.4g}, {:.4g}) mm; {} of {} "
      "parts, {:.0f} particles; moved {:.3f} mm, turned {:.4f} deg\n",
      name, before.median_px, after.median_px, after.worst_px, after.worst_at_mm[0], after.worst_at_mm[1],
      after.worst_at_mm[2], after.parts, parts, after.votes, move[0], move[1]);
}

std::string json_of(const std::string& name, const CameraDisparity& before, const CameraDisparity& after,
                    const std::array<double, 2>& move) {
  return fmt::format(
      R"({{"name":{},"before_px":{},"before_worst_px":{},"after_px":{},"worst_px":{},"worst_at_mm":[{},{},{}],)"
      R"("parts":{},"particles":{},"moved_mm":{},"turned_deg":{}}})",
      json_string(name), json_number(before.median_px), json_number(before.worst_px), json_number(after.median_px),
      json_number(after.worst_px), json_number(after.worst_at_mm[0]), json_number(after.worst_at_mm[1]),
      json_number(after.worst_at_mm[2]), after.parts, json_number(after.votes), json_number(move[0]),
      json_number(move[1]));
}

ExitCode run(const Options& given) {
  const Config config = resolve(given);
  RefineOptions options = given.refine;
  for (std::size_t k = 0; k < 3; ++k) options.parts[k] = static_cast<std::size_t>(given.parts[k]);
  options.self_calibration.freedom = given.fit == "pose"    ? CameraFreedom::pose
                                     : given.fit == "focal" ? CameraFreedom::focal
                                                            : CameraFreedom::distortion;
  const Rig start = read_rig(config.multi_view.rig);
  const RefinedRig refined = refine_rig(config, options);
  write_rig(refined.rig, given.output);
  const std::size_t parts = options.parts[0] * options.parts[1] * options.parts[2];
  std::string text;
  for (std::size_t c = 0; c < refined.place.size(); ++c) {
    const RigCamera& camera = refined.rig.cameras[refined.place[c]];
    const auto move = move_of(start.cameras[refined.place[c]].model, camera.model);
    const CameraDisparity &before = refined.found.before[c], &after = refined.found.after[c];
    text += given.json ? (c == 0 ? "" : ",") + json_of(camera.name, before, after, move)
                       : line_of(camera.name, before, after, parts, move);
    if (after.worst_px > kMuch_px)
      std::cerr << fmt::format(
          "warning: {} still misses by {:.2g} px in one part of the volume; try --fit focal, or "
          "calibrate with a target\n",
          camera.name, after.worst_px);
  }
  std::cout << (given.json
                    ? fmt::format("{{\"instants\":{},\"parts\":{},\"cameras\":[{}]}}\n", refined.instants, parts, text)
                    : text);
  std::cerr << "wrote " << given.output << '\n';
  return ExitCode::ok;
}

}  // namespace

void add_calibrate_refine(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command command = calibrate.add_subcommand("refine", "A rig put right by images of particles (self-calibration)");
  command.add_option("images", options->images,
                     "folder of all cameras' images; default: replay.path of the configuration");
  command.add_option("--start", options->start, "the rig as it was (TOML); default: multi_view.rig");
  command.add_option("-c,--config", options->config, "configuration (TOML) with [multi_view]: volume and detector");
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_option("-o,--output", options->output, "the rig (TOML)").required();
  command
      .add_option("--search", options->refine.self_calibration.search_px,
                  "how far off projections may be in the first round, px; a third of it in the next, to 1")
      .range(0.1, 50.0)
      .show_default();
  command.add_option("--rounds", options->refine.self_calibration.rounds, "corrections")
      .range(std::size_t{1}, std::size_t{20})
      .show_default();
  command
      .add_option("--fit", options->fit,
                  "what is fitted: pose; focal: and the focal length; distortion: and k1, p1, p2")
      .one_of({"pose", "focal", "distortion"})
      .show_default();
  command.add_option("--parts", options->parts, "parts of the volume along x, y and z")
      .expected(3)
      .allow_extra_args(false)
      .range(1, 64)
      .show_default();
  command.add_option("--frames", options->refine.frames, "instants to look at, spread over the recording")
      .range(std::size_t{1}, std::size_t{100000})
      .show_default();
  command.add_flag("--json", options->json, "print the figures as one JSON object");
  command.footer(
      "Examples:\n"
      "  rapidptv calibrate refine frames/ --start rig.toml -o better.toml\n"
      "  rapidptv calibrate refine --config run.toml --search 8 --fit focal --json -o better.toml");
  command.callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rptv
