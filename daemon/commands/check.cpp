// SPDX-License-Identifier: MIT
// `rapidptv check`: would a run with this configuration start, and do its cameras give what it needs?
#include <iostream>

#include "daemon/commands/command.hpp"
#include "daemon/config_check.hpp"
#include "daemon/hardware_check.hpp"

namespace rptv {
namespace {

struct CheckOptions {
  std::string config;
  std::vector<std::string> set;
  bool json = false, hardware = false;
  double duration_s = 5;
};

ExitCode check_cameras(const CheckOptions& options) {
  const HardwareCheck found = check_hardware(load_config(options.config, options.set), options.duration_s);
  std::cout << (options.json ? to_json(found) + "\n" : to_text(found)) << std::flush;
  if (!found.problem.empty()) throw Error(ExitCode::unavailable, found.problem);
  return ExitCode::ok;
}

ExitCode check(const CheckOptions& options) {
  if (options.hardware) return check_cameras(options);
  const auto results = check_config(options.config, options.set);
  std::cout << (options.json ? to_json(results) + "\n" : to_text(results)) << std::flush;
  if (const CheckResult* failed = first_failure(results)) throw Error(failed->code, failed->text);
  return ExitCode::ok;
}

}  // namespace

void add_check(Command app, Action& chosen) {
  auto options = std::make_shared<CheckOptions>();
  Command command = app.add_subcommand("check", "Say whether a run with this configuration would start");
  command.add_option("-c,--config,config", options->config, "configuration (TOML)").required();
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_flag("--json", options->json, "print one JSON object");
  command.add_flag("--hardware", options->hardware, "instead: let the cameras run, and say what each of them gives");
  command.add_option("--seconds", options->duration_s, "how long --hardware lets them run").range(1.0, 3600.0);
  command.footer(
      "Reads the configuration, the calibration and every image's header, builds the stages and binds the endpoints\n"
      "for a moment. The exit code is that of the first failure: 66 no input, 65 bad data, 78 configuration, ...\n"
      "--hardware takes frames in as a run does and tells each camera's rate, losses by cause, driver counters, clock\n"
      "and skew. Exit code 69: a camera is absent or gave no frame, or no set of all cameras was made.\n"
      "Examples:\n"
      "  rapidptv check rig.toml\n"
      "  rapidptv check rig.toml --hardware --seconds 10\n"
      "  rapidptv check rig.toml --set publisher.endpoint=tcp://127.0.0.1:5555 --json");
  command.callback([options, &chosen] { chosen = [options] { return check(*options); }; });
}

}  // namespace rptv
