// SPDX-License-Identifier: MIT
// `rapidptv doctor`: is this machine set up for the configured cameras?
#include <CLI/CLI.hpp>
#include <iostream>

#include "daemon/commands/command.hpp"
#include "daemon/doctor.hpp"
#include "daemon/session.hpp"

namespace rptv {
namespace {

struct DoctorOptions {
  std::string config;
  bool json = false;
};

CameraLoad load_of(const std::string& file) {
  if (file.empty()) return {};
  const auto source = make_source(load_config(file));
  const std::int64_t period_ns = source->nominal_period_ns();
  CameraLoad load;
  for (const CameraInfo& camera : source->cameras())
    if (period_ns > 0)
      load.bytes_per_second += static_cast<double>(camera.shape.bytes()) * 1e9 / static_cast<double>(period_ns);
  return load;
}

ExitCode doctor(const DoctorOptions& options) {
  const auto findings = examine("/", load_of(options.config));
  std::cout << (options.json ? to_json(findings) + "\n" : to_text(findings)) << std::flush;
  return has_problem(findings) ? ExitCode::unavailable : ExitCode::ok;
}

}  // namespace

void add_doctor(CLI::App& app, Action& chosen) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand("doctor", "Say what this machine lacks for cameras, and what mends it");
  command->add_option("-c,--config,config", options->config,
                      "configuration (TOML): also weigh its images against the links");
  command->add_flag("--json", options->json, "print one JSON object");
  command->footer(
      "Exit code 0: no problem (warnings do not count); 69: a problem.\n"
      "Examples:\n"
      "  rapidptv doctor\n"
      "  rapidptv doctor rig.toml --json | jq '.checks[] | select(.verdict != \"ok\") | .mend'");
  command->callback([options, &chosen] { chosen = [options] { return doctor(*options); }; });
}

}  // namespace rptv
