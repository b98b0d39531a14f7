// SPDX-License-Identifier: MIT
// `rapidptv doctor`: is this machine set up for the configured cameras?
#include <iostream>

#include "daemon/commands/command.hpp"
#include "daemon/doctor.hpp"
#include "daemon/doctor_plan.hpp"

namespace rptv {
namespace {

struct DoctorOptions {
  std::string config;
  bool json = false;
};

ExitCode doctor(const DoctorOptions& options) {
  const DoctorPlan plan = options.config.empty() ? DoctorPlan() : plan_of(load_config(options.config));
  std::vector<Finding> findings = examine("/", plan.cameras);
  for (const auto& folder : plan.output_folders) findings.push_back(examine_disk(folder, plan.output_bytes_per_second));
  findings.insert(findings.end(), plan.findings.begin(), plan.findings.end());
  std::cout << (options.json ? to_json(findings) + "\n" : to_text(findings)) << std::flush;
  return has_problem(findings) ? ExitCode::unavailable : ExitCode::ok;
}

}  // namespace

void add_doctor(Command app, Action& chosen) {
  auto options = std::make_shared<DoctorOptions>();
  Command command = app.add_subcommand("doctor", "Say what this machine lacks for cameras, and what mends it");
  command.add_option("-c,--config,config", options->config,
                     "configuration (TOML): also weigh its images against the links and its files against the disk");
  command.add_flag("--json", options->json, "print one JSON object");
  command.footer(
      "With a configuration it opens the cameras for a moment, and writes up to 256 MiB, for some 2 s, into a file "
      "that\n"
      "nobody sees in the folder of the outputs, to learn how fast the disk is.\n"
      "Exit code 0: no problem (warnings do not count); 69: a problem.\n"
      "Examples:\n"
      "  rapidptv doctor\n"
      "  rapidptv doctor rig.toml --json | jq '.checks[] | select(.verdict != \"ok\") | .mend'");
  command.callback([options, &chosen] { chosen = [options] { return doctor(*options); }; });
}

}  // namespace rptv
