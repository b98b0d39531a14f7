// SPDX-License-Identifier: MIT
// `rapidptv calibrate cameras`: images of a target by several cameras in, rig and report out.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>

#include "calibration/cameras/calibrate_cameras.hpp"
#include "calibration/cameras/cameras_report.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"
#include "daemon/board_files.hpp"
#include "daemon/commands/calibrate.hpp"
#include "daemon/progress.hpp"
#include "replay/colour_png.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> images;
  std::string board, output, report, pattern = "cam{camera}_{view}.*", world_view;
  std::vector<std::string> glass;
  std::vector<int> size_px;
  bool allow_missing = false, keep_outliers = false, fit_k3 = false, fit_glass = false, json = false;
};

double positive(const std::string& word) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (word.empty() || *end != '\0' || !(value > 0) || !std::isfinite(value))
    throw Error(ExitCode::usage, fmt::format("--glass: {} is no positive number; give DISTANCE THICKNESS INDEX LIQUID, "
                                             "and CAMERA: before the distance for one camera's own window",
                                             in_quotes(word)));
  return value;
}

/// Across the axis of the camera that it is `words[0]` mm from, until --fit-glass turns it.
RefractiveStack stack_of(std::span<const std::string> words) {
  const double distance_mm = positive(words[0]), thickness_mm = positive(words[1]);
  return {
      {0, 0, -1}, {1.0}, {{-distance_mm, {positive(words[2])}}, {-distance_mm - thickness_mm, {positive(words[3])}}}};
}

/// --glass [CAMERA:]DISTANCE THICKNESS INDEX LIQUID, any number of times.
void add_glass(const std::vector<std::string>& glass, const BoardSet& set, CameraCalibrationOptions& options) {
  for (std::size_t i = 0; i + 4 <= glass.size(); i += 4) {
    std::vector<std::string> words(glass.begin() + static_cast<std::ptrdiff_t>(i),
                                   glass.begin() + static_cast<std::ptrdiff_t>(i + 4));
    const std::size_t colon = words[0].rfind(':');
    const std::string camera = colon == std::string::npos ? "" : words[0].substr(0, colon);
    if (colon != std::string::npos) words[0].erase(0, colon + 1);
    const auto at = std::find_if(set.cameras.begin(), set.cameras.end(),
                                 [&](const CameraImages& known) { return known.name == camera; });
    if (colon != std::string::npos && at == set.cameras.end())
      throw Error(ExitCode::usage, fmt::format("--glass: there is no camera {}; the first is '{}', the last '{}'",
                                               in_quotes(camera), set.cameras.front().name, set.cameras.back().name));
    if (colon != std::string::npos) options.windows.resize(set.cameras.size());
    RefractiveStack& stack = colon == std::string::npos
                                 ? options.stack
                                 : options.windows[static_cast<std::size_t>(at - set.cameras.begin())];
    if (!stack.interfaces.empty())
      throw Error(ExitCode::usage, fmt::format("--glass {} is given twice; give one window for each camera, or one for "
                                               "all",
                                               words[0]));
    stack = stack_of(words);
  }
  for (std::size_t c = 0; c < options.windows.size() && options.stack.interfaces.empty(); ++c)
    if (options.windows[c].interfaces.empty())
      throw Error(
          ExitCode::usage,
          fmt::format("--glass: camera '{}' has no window and others have; give it one, or one for all the rest",
                      set.cameras[c].name));
}

CameraCalibrationOptions options_of(const Options& options, const BoardSet& set) {
  CameraCalibrationOptions result;
  result.single.fit_k3 = options.fit_k3, result.single.drop_outliers = !options.keep_outliers;
  add_glass(options.glass, set, result);
  if (options.fit_glass && result.stack.interfaces.empty())
    throw Error(ExitCode::usage,
                "--fit-glass turns the window that cameras share, and each has its own: images hardly tell it from the "
                "lens behind it; measure them, and leave --fit-glass out");
  result.fit_stack = options.fit_glass;
  if (options.world_view.empty()) return result;
  const auto at = std::find(set.views.begin(), set.views.end(), options.world_view);
  if (at == set.views.end())
    throw Error(ExitCode::usage,
                fmt::format("--world-view {} is none of the {} views, {} to {}", in_quotes(options.world_view),
                            set.views.size(), set.views.front(), set.views.back()));
  result.world_view = static_cast<std::size_t>(at - set.views.begin());
  return result;
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush())
    throw Error(ExitCode::io, fmt::format("{}: cannot be written; check folder, permissions and space", file.string()));
}

void write_report(const fs::path& folder, const CameraCalibration& calibration) {
  std::error_code error;
  fs::create_directories(folder, error);
  write_text(folder / "report.txt", to_text(calibration));
  write_text(folder / "report.json", to_json(calibration) + "\n");
  write_text(folder / "residuals.csv", residual_table(calibration));
  write_colour_png(folder / "coverage.png", draw_coverage(calibration));
}

ExitCode run(const Options& options) {
  const Board board = read_board(options.board);
  const auto files = find_board_files(options.images, options.pattern);
  BoardSet set;
  {
    Progress progress("finding the target", files.size());
    set = read_board_set(files, board, options.size_px, options.allow_missing, [&] { progress.advance(); });
  }
  const CameraCalibration calibration = calibrate_cameras(set, options_of(options, set));
  write_rig(calibration.rig, options.output);
  if (!options.report.empty()) write_report(options.report, calibration);
  std::cout << (options.json ? to_json(calibration) + "\n" : to_text(calibration));
  std::cerr << "wrote " << options.output << (options.report.empty() ? "" : " and the report in " + options.report)
            << '\n';
  return ExitCode::ok;
}

}  // namespace

void add_calibrate_cameras(Command calibrate, Action& chosen) {
  auto options = std::make_shared<Options>();
  Command command = calibrate.add_subcommand("cameras", "Lenses and poses of several cameras from images of a target");
  command.add_option("images", options->images, "images, or folders of them; for measured points text files")
      .required();
  command.add_option("--board", options->board, "the target (TOML)").required();
  command.add_option("-o,--output", options->output, "the rig (TOML)").required();
  command.add_option("--report", options->report, "folder for report, residuals and coverage");
  command.add_option("--pattern", options->pattern, "how files are named: {camera}, {view}, * for anything")
      .show_default();
  command.add_option("--world-view", options->world_view,
                     "the rig's frame is the target's in this view, not the first camera's");
  command.add_flag("--allow-missing", options->allow_missing, "cameras need not have an image of each view");
  command.add_flag("--keep-outliers", options->keep_outliers,
                   "do not drop views that fit several times worse than others");
  command.add_flag("--k3", options->fit_k3, "fit the sixth order of the radial distortion: wide lenses");
  Option glass =
      command
          .add_option("--glass", options->glass,
                      "the target stands behind a window: its DISTANCE from the first camera and THICKNESS (mm), "
                      "refractive INDEX of the glass, and of the LIQUID; CAMERA:DISTANCE and so on: that camera's own "
                      "window, from itself")
          .each_time(4);
  command.add_flag("--fit-glass", options->fit_glass, "fit where the window is and how it is turned").needs(glass);
  command.add_option("--size", options->size_px, "measured points: WIDTH and HEIGHT of the images, px")
      .expected(2)
      .allow_extra_args(false)
      .positive();
  command.add_flag("--json", options->json, "print the report as one JSON object");
  command.footer(
      "Every view is one pose of the target, seen by several cameras at one moment; docs/calibration.md says how to "
      "take\n"
      "them. A board's file: kind = \"charuco\", columns, rows, square_mm, marker_mm, dictionary.\n\n"
      "Examples:\n"
      "  rapidptv calibrate cameras charuco/ --board board.toml -o rig.toml --report report/\n"
      "  rapidptv calibrate cameras left/ right/ --pattern '{camera}/{view}.png' --board board.toml -o rig.toml\n"
      "  rapidptv calibrate cameras in_water/ --board board.toml --glass 430 6 1.46 1.333 --fit-glass -o rig.toml\n"
      "  rapidptv calibrate cameras in_water/ --board board.toml --glass cam0:430 6 1.46 1.333 --glass cam1:390 6 1.46 "
      "1.333 -o rig.toml\n"
      "  rapidptv calibrate cameras cube/ --pattern 'cam{camera}_{view}.txt' --board cube.toml --size 1280 1024 -o "
      "rig.toml");
  command.callback([options, &chosen] { chosen = [options] { return run(*options); }; });
}

}  // namespace rptv
