// SPDX-License-Identifier: MIT
// `rapidptv demo`: simulates a short run, replays it in real time through the daemon and compares with the truth.
#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <iostream>

#include "daemon/child_process.hpp"
#include "daemon/commands/command.hpp"
#include "daemon/live_listener.hpp"
#include "daemon/simulated_run.hpp"
#include "simulation/score.hpp"
#include "simulation/truth.hpp"
#include "simulation/wall_profile.hpp"

namespace rptv {
namespace {

constexpr double kDegrees = 57.29577951308232;

struct DemoOptions {
  std::filesystem::path out = "demo-out";
  std::int64_t frames = 300;
  double rate_hz = 100;
  std::int64_t seed = 1;
};

void simulate(const DemoOptions& options) {
  ScenarioSettings scenario;
  scenario.frames = options.frames;
  scenario.rate_hz = options.rate_hz;
  scenario.seed = options.seed;
  const SimulatedRunReport run = write_simulated_run(scenario, {.folder = options.out, .threads = 0});
  std::cout << fmt::format("  {:.1f} s; {:.0f} particles a frame, {:.0f} of them fully in view\n", run.elapsed_s,
                           run.particles_per_frame, run.in_view_per_frame);
}

/// Replays the images through a daemon of its own, as a user would, with this process as the subscriber.
void replay(const DemoOptions& options, const std::string& endpoint, LiveListener& listener) {
  ChildProcess daemon({"run", "--config", SimulatedRunFiles(options.out).rig, "--tracks", options.out / "tracks.csv",
                       "--points", options.out / "points.csv", "--report", options.out / "report.json", "--endpoint",
                       endpoint, "--wait-for-subscriber", "--log-level", "warning"});
  constexpr int kPollMs = 100;
  while (listener.poll(kPollMs) || !daemon.ended()) {
  }
  if (daemon.exit_code() != 0) throw Error(ExitCode::internal, "the daemon failed; its message stands above");
}

void print_live(const LiveListener& listener) {
  std::cout << fmt::format("\nLive: {} frames and {} track points received, {} frames missing\n", listener.frames(),
                           listener.track_points(), listener.missing_frames())
            << listener.latency().table();
  if (listener.status().losses.empty()) std::cout << "  losses: none\n";
  for (const LossCount& loss : listener.status().losses)
    std::cout << fmt::format("  lost: {} × {} at {}\n", loss.count, name_of(loss.cause), loss.place);
}

void print_score(const Score& score) {
  const DetectionScore& d = score.detection;
  std::cout << fmt::format(
      "\nAgainst the truth: {} of {} particles in view found ({:.1f} %), {} ghosts in {} measured ({:.2f} %)\n"
      "  rms error x {:.1f}, y {:.1f}, z {:.1f} µm\n"
      "  {} tracks: purity {:.2f} %, coverage {:.1f} %, fragmentation {:.2f}, {} identity switches\n",
      d.found, d.truth, 100 * d.recall, d.ghosts, d.measured,
      100 * static_cast<double>(d.ghosts) / static_cast<double>(d.measured > 0 ? d.measured : 1),
      1e3 * d.position_mm.rms[0], 1e3 * d.position_mm.rms[1], 1e3 * d.position_mm.rms[2], score.track.tracks,
      100 * score.track.purity, 100 * score.track.coverage, score.track.fragmentation, score.track.id_switches);
}

void print_profile(const WallProfile& profile) {
  std::cout << "\nOscillating wall (Stokes' second problem): measured and theory by height above the wall\n"
               "  height mm   amplitude µm    theory   phase °   theory   tracks\n";
  for (const WallProfileBin& bin : profile.bins)
    std::cout << fmt::format("  {:>9.2f}   {:>12.1f} {:>9.1f} {:>9.1f} {:>8.1f} {:>8}\n", bin.height_mm,
                             1e3 * bin.amplitude_mm, 1e3 * bin.theory_amplitude_mm, kDegrees * bin.phase_rad,
                             kDegrees * bin.theory_phase_rad, bin.tracks);
  std::cout << fmt::format(
      "  rms deviation: amplitude {:.2f} % of the wall's, phase {:.2f}°; fitted wall amplitude {:.1f} µm (true "
      "{:.1f}), "
      "Stokes layer {:.3f} mm (true {:.3f})\n",
      100 * profile.amplitude_rms_relative, kDegrees * profile.phase_rms_rad, 1e3 * profile.wall_amplitude_mm,
      1e3 * profile.theory.wall_amplitude_mm, profile.stokes_layer_mm, profile.theory.stokes_layer_mm);
}

ExitCode demo(const DemoOptions& options) {
  std::cout << fmt::format("Simulating {} light-field images of particles beside an oscillating wall …\n",
                           options.frames)
            << std::flush;
  simulate(options);
  std::cout << fmt::format("Replaying them at {} Hz through the daemon, with a subscriber attached …\n",
                           options.rate_hz)
            << std::flush;
  const std::string endpoint = fmt::format("ipc://@rapidptv-demo-{}", getpid());
  LiveListener listener(endpoint);
  replay(options, endpoint, listener);
  print_live(listener);
  const Measurement tracks = read_measurement(options.out / "tracks.csv");
  print_score(score(tracks, read_truth(SimulatedRunFiles(options.out).truth), ScoreSettings{}));
  const WallProfile profile = measure_wall_profile(
      tracks.rows, read_scenario(SimulatedRunFiles(options.out).scenario).flow, WallProfileSettings{});
  print_profile(profile);
  write_wall_profile(profile, options.out / "profile.csv");
  std::cout << "\nImages, configuration, tracks and profile are in " << options.out.string() << "\n";
  return ExitCode::ok;
}

}  // namespace

void add_demo(Command app, Action& chosen) {
  auto options = std::make_shared<DemoOptions>();
  Command command = app.add_subcommand("demo", "Simulate, replay in real time through the daemon, score, report");
  command.add_option("-o,--out", options->out, "folder for images and results").show_default();
  command.add_option("--frames", options->frames, "frames to simulate").show_default().range(50, 100000);
  command.add_option("--rate", options->rate_hz, "frames per second").show_default().range(20.0, 2000.0);
  command.add_option("--seed", options->seed, "another seed: other particles, other noise").show_default();
  command.footer("Examples:\n  rapidptv demo\n  rapidptv demo --out /tmp/demo --frames 1000 --seed 7");
  command.callback([options, &chosen] { chosen = [options] { return demo(*options); }; });
}

}  // namespace rptv
