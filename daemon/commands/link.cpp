// SPDX-License-Identifier: MIT
// `rapidptv link`: a table of points in, a table of tracks out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>

#include "core/tables.hpp"
#include "daemon/commands/command.hpp"
#include "tracking/link_table.hpp"

namespace rptv {
namespace {

struct LinkOptions {
  std::string points;
  std::string output = "-";
  double rate_hz = 0;
  LinkerSettings linker;
};

void tell(const LinkOptions& options, const LinkerCounters& counted) {
  std::cerr << fmt::format("linked {} frames: {} tracks, {} links, largest subnetwork {}\n", counted.frames,
                           counted.births, counted.links, counted.largest_subnet);
  if (counted.truncated_searches > 0)
    std::cerr << fmt::format(
        "{} searches found more than {} particles in range and used the nearest: reduce --search-range or raise "
        "--max-candidates\n",
        counted.truncated_searches, options.linker.max_candidates);
  if (counted.forgotten_tracks > 0)
    std::cerr << fmt::format("{} unseen tracks ended before their memory did: raise --max-tracks\n",
                             counted.forgotten_tracks);
  if (counted.clock_faults > 0)
    std::cerr << fmt::format("{} steps of t were jumps: velocities were kept over them\n", counted.clock_faults);
}

ExitCode link(const LinkOptions& options) {
  if (options.output != "-" && options.output == options.points)
    throw Error(ExitCode::usage, options.output + " is both input and output; give another -o");
  PointsReader points(options.points);
  const bool no_time = !points.has_time() && options.rate_hz == 0;
  if (no_time) std::cerr << "no column t and no --rate: velocities are mm per frame, t counts frames\n";
  TracksWriter tracks(options.output);
  const LinkerCounters counted = link_table(points, options.points == "-" ? "stdin" : options.points, options.linker,
                                            options.rate_hz > 0 ? options.rate_hz : kOneFramePerSecond, tracks);
  tracks.close();
  tell(options, counted);
  return ExitCode::ok;
}

}  // namespace

void add_link(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<LinkOptions>();
  LinkerSettings& linker = options->linker;
  CLI::App* command = app.add_subcommand("link", "Link points into tracks (CSV to CSV)");
  command->add_option("points", options->points, "table with columns frame,x,y[,z][,t]; - is standard input")
      ->required();
  command->add_option("-o,--output", options->output, "table of tracks; - is standard output")->capture_default_str();
  command->add_option("--search-range", linker.search_range_mm, "farthest step between two frames, mm")
      ->required()
      ->check(CLI::Range(1e-9, 1e9));
  command->add_option("--memory", linker.memory, "frames that a particle may be unseen for")
      ->check(CLI::Range(std::int64_t{0}, std::int64_t{1'000'000}))
      ->capture_default_str();
  command->add_option("--predict,--predictor", linker.predict, "where to look: at the last position, or carried on")
      ->check(CLI::IsMember({"none", "velocity"}))
      ->capture_default_str();
  command->add_option("--rate", options->rate_hz, "frames per second of a table without column t, Hz")
      ->check(CLI::Range(1e-6, 1e9));
  command->add_option("--max-particles", linker.max_particles, "most points in one frame")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000}))
      ->capture_default_str();
  command->add_option("--max-tracks", linker.max_tracks, "most tracks alive at once, unseen ones included")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{10'000'000}))
      ->capture_default_str();
  command->add_option("--max-candidates", linker.max_candidates, "nearest points considered per track")
      ->check(CLI::Range(std::int64_t{1}, std::int64_t{1024}))
      ->capture_default_str();
  command->footer(
      "Rows must be sorted by frame. Frames come out as they are complete, so a pipe works; trackpy's tables (x, y, "
      "frame, ...)\nare read as they are.\n\n"
      "Examples:\n"
      "  rapidptv link points.csv --search-range 0.5 --memory 3 -o tracks.csv\n"
      "  rapidptv link points.csv --search-range 0.2 --predict velocity --rate 150 -o tracks.csv\n"
      "  rapidptv reconstruct --config rig.toml | rapidptv link - --search-range 0.5 > tracks.csv");
  command->callback([options, &chosen] { chosen = [options] { return link(*options); }; });
}

}  // namespace rptv
