// SPDX-License-Identifier: MIT
// `rapidptv calibrate wand`: a rig and images' points of a rod of known length in, the rig with better poses out.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "calibration/cameras/wand.hpp"
#include "core/error.hpp"
#include "core/json.hpp"
#include "daemon/board_files.hpp"
#include "daemon/commands/calibrate.hpp"

namespace rptv {
namespace {

struct Options {
  std::vector<std::string> points;
  std::string start, output, pattern = "cam{camera}_{view}.txt";
  double length_mm = 0;
  bool fit_lenses = false, json = false;
};

/// The rod's ends, for read_board_set(): points 1 and 2.
Board rod_of(double length_mm) {
  Board rod;
  rod.kind = "points", rod.ids = {1, 2};
  rod.known_mm = {{0, 0, 0}, {length_mm, 0, 0}};
  return rod;
}

/// The cameras of the files in the rig's order.
BoardSet in_order_of(const Rig& rig, BoardSet set, const std::string& origin) {
  std::vector<std::size_t> place;
  for (const auto& camera : set.cameras) {
    const auto at =
        std::find_if(rig.cameras.begin(), rig.cameras.end(), [&](const RigCamera& c) { return c.name == camera.name; });
    if (at == rig.cameras.end())
      throw Error(ExitCode::bad_data,
                  fmt::format("{}: has no camera {} as the files' names do; rename them, or mend --pattern", origin,
                              camera.name));
    place.push_back(static_cast<std::size_t>(at - rig.cameras.begin()));
  }
  for (auto& image : set.images) image.camera = place[image.camera];
  set.cameras.clear();
  for (const auto& camera : rig.cameras)
    set.cameras.push_back({camera.name, camera.model.intrinsics().width_px, camera.model.intrinsics().height_px});
  return set;
}

ExitCode run(const Options& options) {
  const Rig start = read_rig(options.start);
  const auto files = find_board_files(options.points, options.pattern);
  const auto& lens = start.cameras[0].model.intrinsics();
  const BoardSet seen = read_board_set(files, rod_of(options.length_mm), {lens.width_px, lens.height_px}, true, [] {});
  const WandCalibration wand =
      calibrate_with_wand(start, in_order_of(start, seen, options.start), options.length_mm, options.fit_lenses);
  write_rig(wand.rig, options.output);
  if (options.json)
    std::cout << fmt::format(
        "{{\"rods\":{},\"before_rms_mm\":{},\"rms_mm\":{},\"largest_mm\":{},\"rms_px\":{},"
        "\"expected\":{}}}\n",
        wand.rods, json_number(wand.before_rms_mm), json_number(wand.rms_mm), json_number(wand.largest_mm),
        json_number(wand.result.rms_px), to_json(wand.volume));
  else
    std::cout << fmt::format(
        "rods              {} views with both ends\n"
        "length            {:.6g} mm; rms error before {:.4f} mm, now {:.4f} mm, largest {:.4f} mm\n"
        "reprojection      rms {:.4f} px, {} of {} ends beyond 5 standard errors\n{}",
        wand.rods, options.length_mm, wand.before_rms_mm, wand.rms_mm, wand.largest_mm, wand.result.rms_px,
        wand.result.outliers, wand.result.residuals.size(), to_text(wand.volume));
  std::cerr << "wrote " << options.output << '\n';
  return ExitCode::ok;
}

}  // namespace

void add_calibrate_wand(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command command = calibrate.add_subcommand("wand", "Better poses of a rig from a rod of known length");
  command.add_option("points", options->points, "text files, or folders of them: `1 column row`, `2 column row`")
      .required();
  command.add_option("--start", options->start, "the rig as it was (TOML)").required();
  command.add_option("--length", options->length_mm, "from end 1 to end 2 of the rod, mm").required().positive();
  command.add_option("-o,--output", options->output, "the rig (TOML)").required();
  command.add_option("--pattern", options->pattern, "how files are named: {camera}, {view}, * for anything")
      .show_default();
  command.add_flag("--lenses", options->fit_lenses, "adjust focal lengths, principal points and distortion, too");
  command.add_flag("--json", options->json, "print the figures as one JSON object");
  command.footer(
      "Example:\n"
      "  rapidptv calibrate wand ends/ --start rig.toml --length 100 -o better.toml");
  command.callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rptv
