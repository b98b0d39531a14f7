// SPDX-License-Identifier: MIT
// `rapidptv link`: a table of points in, a table of tracks out.
#include <fmt/format.h>

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
  std::vector<double> range_mm;
  std::size_t smooth_frames = 0;
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
  if (counted.adapted_subnets > 0)
    std::cerr << fmt::format("{} subnetworks were solved at a reduced search range\n", counted.adapted_subnets);
  if (counted.cut_subnets > 0)
    std::cerr << fmt::format("{} subnetworks were only approximated: reduce --search-range, or raise --deadline\n",
                             counted.cut_subnets);
  if (counted.forgotten_tracks > 0)
    std::cerr << fmt::format("{} unseen tracks ended before their memory did: raise --max-tracks\n",
                             counted.forgotten_tracks);
  if (counted.clock_faults > 0)
    std::cerr << fmt::format("{} steps of t were jumps: velocities were kept over them\n", counted.clock_faults);
}

ExitCode link(LinkOptions options) {
  if (options.output != "-" && options.output == options.points)
    throw Error(ExitCode::usage, options.output + " is both input and output; give another -o");
  if (options.smooth_frames > 0 && !options.linker.filters())
    throw Error(ExitCode::usage, "--smooth needs a Kalman filter; add --predictor kalman");
  if (options.range_mm.size() == 2)
    throw Error(ExitCode::usage, "--search-range has 2 values; give one, or one each for x, y and z");
  options.linker.search_range_mm = options.range_mm[0];
  if (options.range_mm.size() == 3) options.linker.search_range_xyz_mm = options.range_mm;
  options.linker.check();
  PointsReader points(options.points);
  const bool no_time = !points.has_time() && options.rate_hz == 0;
  if (no_time) std::cerr << "no column t and no --rate: velocities are mm per frame, t counts frames\n";
  TracksWriter tracks(options.output, {.estimate = options.linker.filters()});
  const LinkTableOptions how{.rate_hz = options.rate_hz > 0 ? options.rate_hz : kOneFramePerSecond,
                             .smooth_frames = options.smooth_frames,
                             .at_once = options.points == "-"};
  const LinkerCounters counted =
      link_table(points, options.points == "-" ? "stdin" : options.points, options.linker, how, tracks);
  tracks.close();
  tell(options, counted);
  return ExitCode::ok;
}

void add_motion(Command command, LinkOptions& options) {
  LinkerSettings& linker = options.linker;
  command
      .add_option("--predict,--predictor", linker.predict, "where to look: at the last position, or carried on by ...")
      .one_of({"none", "velocity", "flow", "kalman", "kalman_acceleration"})
      .show_default();
  command.add_option("--start-up", linker.start_up, "what a new track is expected to do, with a predictor")
      .one_of({"nearest", "rest"})
      .show_default();
  command
      .add_option("--model-error", linker.model_error_mm, "rms displacement that a Kalman filter does not explain, mm")
      .range(0.0, 1e9);
  command.add_option("--noise", linker.noise_mm, "rms error of points without covariance, mm").range(0.0, 1e9);
  command.add_option("--gate", linker.gate_sigma, "largest Mahalanobis distance, beside the search range")
      .range(0.0, 1e3);
  command.add_option("--flow-bin", linker.flow_bin_mm, "cubes that the flow is averaged over, mm").range(0.0, 1e9);
  command.add_option("--smooth", options.smooth_frames, "frames that each row waits for, to be smoothed by them")
      .range(std::size_t{0}, std::size_t{1000});
}

void add_bounds(Command command, LinkOptions& options) {
  LinkerSettings& linker = options.linker;
  linker.deadline_ms = 0;  // nobody waits for a table: exact by default
  command.add_option("--adaptive-stop", linker.adaptive_stop_mm, "smallest range for oversize subnetworks, mm")
      .range(0.0, 1e9);
  command.add_option("--adaptive-step", linker.adaptive_step, "factor from one such range to the next")
      .range(0.01, 0.999)
      .show_default();
  command.add_option("--max-subnet", linker.max_subnet, "tracks in a subnetwork from which that begins; 0: never")
      .range(std::int64_t{0}, std::int64_t{10'000'000});
  command.add_option("--deadline", linker.deadline_ms, "time for one frame, ms; 0: none").range(0.0, 1e6);
  command.add_option("--max-particles", linker.max_particles, "most points in one frame")
      .range(std::int64_t{1}, std::int64_t{10'000'000})
      .show_default();
  command.add_option("--max-tracks", linker.max_tracks, "most tracks alive at once, unseen ones included")
      .range(std::int64_t{1}, std::int64_t{10'000'000})
      .show_default();
  command.add_option("--max-candidates", linker.max_candidates, "nearest points considered per track")
      .range(std::int64_t{1}, std::int64_t{1024})
      .show_default();
}

}  // namespace

void add_link(Command app, Action& chosen) {
  auto options = std::make_shared<LinkOptions>();
  Command command = app.add_subcommand("link", "Link points into tracks (CSV to CSV)");
  command.add_option("points", options->points, "table with columns frame,x,y[,z][,t]; - is standard input").required();
  command.add_option("-o,--output", options->output, "table of tracks; - is standard output").show_default();
  command
      .add_option("--search-range", options->range_mm, "farthest step between two frames, mm; or one each: 0.2,0.2,1")
      .required()
      .delimiter(',')
      .expected(1, 3)
      .range(1e-9, 1e9);
  command.add_option("--memory", options->linker.memory, "frames that a particle may be unseen for")
      .range(std::int64_t{0}, std::int64_t{1'000'000})
      .show_default();
  command.add_option("--rate", options->rate_hz, "frames per second of a table without column t, Hz").range(1e-6, 1e9);
  add_motion(command, *options);
  add_bounds(command, *options);
  command.footer(
      "Rows must be sorted by frame. Frames come out as they are complete, so a pipe works; trackpy's tables (x, y, "
      "frame, ...)\nare read as they are. docs/linking.md explains the choices.\n\n"
      "Examples:\n"
      "  rapidptv link points.csv --search-range 0.5 --memory 3 -o tracks.csv\n"
      "  rapidptv link points.csv --search-range 0.1,0.1,0.4 --predictor kalman --smooth 5 --rate 150 -o tracks.csv\n"
      "  rapidptv reconstruct --config rig.toml | rapidptv link - --search-range 0.5 > tracks.csv");
  command.callback([options, &chosen] { chosen = [options] { return link(*options); }; });
}

}  // namespace rptv
