// SPDX-License-Identifier: MIT
// `rapidptv score`: measured points or tracks against the truth, and the profile of the flow that they give.
#include <fmt/format.h>

#include <filesystem>
#include <iostream>

#include "daemon/commands/command.hpp"
#include "simulation/score_report.hpp"

namespace rptv {
namespace {

struct ScoreOptions {
  std::string measured, truth, scenario, profile_csv;
  std::vector<double> radius_mm;
  double phase_sigma_deg = 0;
  bool json = false;
};

ScoreSettings settings_of(const ScoreOptions& options) {
  ScoreSettings settings;
  const auto& radius = options.radius_mm;
  if (radius.size() == 1) settings.radius_mm = {radius[0], radius[0], radius[0]};
  if (radius.size() == 3) settings.radius_mm = {radius[0], radius[1], radius[2]};
  if (radius.size() == 2)
    throw Error(ExitCode::usage, "--radius-mm has 2 numbers; give one for all axes, or three: x y z");
  for (const double value : settings.radius_mm)
    if (!(value > 0)) throw Error(ExitCode::usage, fmt::format("--radius-mm {} is not above 0; give mm", value));
  return settings;
}

ExitCode run_score(const ScoreOptions& options) {
  if (options.truth.empty() && options.scenario.empty())
    throw Error(ExitCode::usage, "nothing to compare with; give --truth truth.csv, --profile scenario.toml, or both");
  const Measurement measured = read_measurement(options.measured);
  std::vector<std::string> json;
  std::string text;
  if (!options.truth.empty()) {
    const ScoreSettings settings = settings_of(options);
    const Score result = score(measured, read_truth(options.truth), settings);
    text += to_text(result, settings);
    json.push_back("\"score\":" + to_json(result));
  }
  if (!options.scenario.empty()) {
    if (!measured.linked)
      throw Error(ExitCode::bad_data, options.measured +
                                          ": has no column 'particle', and a profile needs tracks; link the "
                                          "points first: rapidptv link");
    const auto tell = [&](const auto& profile) {
      text += (text.empty() ? "" : "\n") + to_text(profile);
      json.push_back("\"profile\":" + to_json(profile));
    };
    const ScenarioSettings scenario = read_scenario(options.scenario);
    if (scenario.flow.kind == "duct") {
      const DuctProfile profile = measure_duct_profile(measured.rows, scenario.duct, scenario.rate_hz);
      if (!options.profile_csv.empty()) write_duct_profile(profile, options.profile_csv);
      tell(profile);
    } else if (scenario.flow.kind == "oscillating_wall") {
      WallProfileSettings settings;
      settings.rate_hz = scenario.rate_hz, settings.most_phase_sigma_deg = options.phase_sigma_deg;
      const WallProfile profile = measure_wall_profile(measured.rows, scenario.flow, settings);
      if (!options.profile_csv.empty()) write_wall_profile(profile, options.profile_csv);
      tell(profile);
    } else {
      throw Error(ExitCode::configuration,
                  options.scenario + ": flow.kind = '" + scenario.flow.kind +
                      "' has no profile; give the scenario of an oscillating wall or a duct, or leave --profile out");
    }
  }
  std::cout << (options.json ? "{" + json.front() + (json.size() > 1 ? "," + json.back() : "") + "}\n" : text);
  return ExitCode::ok;
}

}  // namespace

void add_score(Command app, Action& chosen) {
  auto options = std::make_shared<ScoreOptions>();
  Command command = app.add_subcommand("score", "Compare measured particles or tracks with the truth");
  command.add_option("measured", options->measured, "tracks or points table (CSV); - is standard input").required();
  command.add_option("--truth", options->truth, "true tracks (CSV), with the column in_view when not all can be seen");
  command
      .add_option("--radius-mm", options->radius_mm,
                  "a particle is found when it is this near, per axis: one number or x y z (default 0.1 0.1 0.5)")
      .expected(1, 3)
      .delimiter(',');
  command.add_option("--profile", options->scenario,
                     "scenario (TOML) of a wall or a duct: measure its profile and compare with theory");
  command.add_option("--profile-csv", options->profile_csv, "also write the profile to this CSV file");
  command.add_option("--phase-sigma", options->phase_sigma_deg,
                     "wall profile: join layers whose phase has a larger standard error, degrees, with those below");
  command.add_flag("--json", options->json, "print one JSON object");
  command.footer(
      "Definitions: Sciacchitano et al. 2021 (1st LPT challenge); pairs are one to one, nearest first.\n"
      "Examples:\n"
      "  rapidptv score tracks.csv --truth run/truth.csv\n"
      "  rapidptv score points.csv --truth run/truth.csv --radius-mm 0.05,0.05,0.3 --json\n"
      "  rapidptv score tracks.csv --truth run/truth.csv --profile run/scenario.toml --profile-csv profile.csv");
  command.callback([options, &chosen] { chosen = [options] { return run_score(*options); }; });
}

}  // namespace rptv
