// SPDX-License-Identifier: MIT
// `rapidptv simulate`: images of a flow with known truth, in a folder that `run` can replay.
#include <fmt/format.h>

#include <iostream>

#include "core/json.hpp"
#include "daemon/commands/command.hpp"
#include "daemon/simulated_views.hpp"
#include "simulation/camera_report.hpp"
#include "simulation/challenge_rig.hpp"
#include "simulation/shipped_file.hpp"

namespace rptv {
namespace {

struct SimulateOptions {
  std::string out, scenario;
  std::vector<std::string> set;
  unsigned threads = 0;
  bool list = false, show = false, describe = false, json = false;
};

ScenarioSettings resolve(const SimulateOptions& options) {
  ScenarioSettings scenario;
  if (!options.scenario.empty()) scenario = read_scenario(find_shipped("scenarios", options.scenario));
  FieldList fields;
  scenario.fields(fields);
  for (const auto& assignment : options.set) set_field(fields, assignment);
  check_scenario(scenario, options.scenario.empty() ? "scenario" : options.scenario);
  return scenario;
}

ExitCode simulate(const SimulateOptions& options) {
  if (options.list) {
    for (const std::string& name : shipped_names("scenarios")) std::cout << name << '\n';
    return ExitCode::ok;
  }
  ScenarioSettings scenario = resolve(options);
  if (options.show) {
    FieldList fields;
    scenario.fields(fields);
    std::cout << to_toml(fields, kScenarioSchema);
    return ExitCode::ok;
  }
  const bool views = !scenario.views.rig.empty();
  if (options.describe) {
    std::cout << (views ? to_toml(rig_of(scenario)) : describe_camera(scenario));
    return ExitCode::ok;
  }
  if (options.out.empty())
    throw Error(ExitCode::usage, "no folder to write to; give --out DIR (or --show the scenario)");
  const SimulatedRunOptions run{options.out, options.threads};
  const auto report = views ? write_simulated_views(scenario, run) : write_simulated_run(scenario, run);
  if (options.json)
    std::cout << fmt::format(
        R"({{"folder":{},"frames":{},"particles_per_frame":{},"in_view_per_frame":{},"bytes":{},"rays":{},"frames_elapsed_s":{},"elapsed_s":{}}})"
        "\n",
        json_string(options.out), report.frames, report.particles_per_frame, report.in_view_per_frame, report.bytes,
        report.rays, report.frames_elapsed_s, report.elapsed_s);
  else
    std::cerr << fmt::format(
        "{} frames in {:.1f} s ({:.1f} MB), {:.1f} frames/s{}; per frame {:.0f} particles, {:.0f} of them fully in "
        "view\n"
        "next: rapidptv run --config {}/rig.toml --tracks tracks.csv\n",
        report.frames, report.elapsed_s, 1e-6 * static_cast<double>(report.bytes),
        static_cast<double>(report.frames) / report.frames_elapsed_s,
        views
            ? ""
            : fmt::format(", {:.1f} million rays/s", 1e-6 * static_cast<double>(report.rays) / report.frames_elapsed_s),
        report.particles_per_frame, report.in_view_per_frame, options.out);
  return ExitCode::ok;
}

}  // namespace

void add_simulate(Command app, Action& chosen) {
  auto options = std::make_shared<SimulateOptions>();
  Command command = app.add_subcommand("simulate", "Make images of a simulated flow, with the truth beside them");
  command.add_option("-o,--out", options->out, "folder to write: frames/, truth.csv, calibration.toml, rig.toml, …");
  command.add_option("--scenario", options->scenario,
                     "name of an installed scenario, or a file (TOML); default: an oscillating wall in a 7 mm cube");
  command.add_flag("--list", options->list, "name the scenarios that are installed, and stop");
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_option("--threads", options->threads, "threads that render; 0: one per processor");
  command.add_flag("--show", options->show, "print the scenario as TOML, with every setting explained, and stop");
  command.add_flag("--describe", options->describe,
                   "print what lens, array and camera amount to (of several cameras: the rig), and stop");
  command.add_flag("--json", options->json, "print a summary as one JSON object");
  command.footer(
      "Examples:\n"
      "  rapidptv simulate --out run\n"
      "  rapidptv simulate --out run --set frames=100 --set flow.frequency_hz=10 --set seed=7\n"
      "  rapidptv simulate --scenario layers --out layers      (others: --list)\n"
      "  rapidptv simulate --scenario layers --describe\n"
      "  rapidptv simulate --scenario lpt_challenge --out lpt --set views.per_pixel=0.025\n"
      "  rapidptv simulate --out dense --set flow.kind=random --set frames=20 --set seeding.per_lenslet=0.1\n"
      "  rapidptv simulate --show > scenario.toml && rapidptv simulate --scenario scenario.toml --out run");
  command.callback([options, &chosen] { chosen = [options] { return simulate(*options); }; });
}

}  // namespace rptv
