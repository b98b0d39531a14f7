// SPDX-License-Identifier: MIT
// `rapidptv show-config`: every setting, its meaning, and the value that a run would use.
#include <iostream>

#include "daemon/commands/command.hpp"
#include "daemon/config.hpp"

namespace rptv {
namespace {

struct ShowConfigOptions {
  std::string config;
  std::vector<std::string> set;
  bool json = false;
};

ExitCode show_config(const ShowConfigOptions& options) {
  const Config config =
      options.config.empty() ? parse_config("", "defaults", options.set) : load_config(options.config, options.set);
  std::cout << (options.json ? to_json(config) + "\n" : to_toml(config)) << std::flush;
  return ExitCode::ok;
}

}  // namespace

void add_show_config(Command app, Action& chosen) {
  auto options = std::make_shared<ShowConfigOptions>();
  Command command = app.add_subcommand("show-config", "Print every setting with its meaning and its value");
  command.add_option("-c,--config,config", options->config, "configuration (TOML); without one: the defaults");
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_flag("--json", options->json, "print one JSON object");
  command.footer(
      "What is printed is a complete configuration: `run` takes it as it is. Paths in a file count from its folder.\n"
      "Examples:\n"
      "  rapidptv show-config > rig.toml\n"
      "  rapidptv show-config rig.toml --set linker.search_range_mm=0.3\n"
      "  rapidptv show-config rig.toml --json");
  command.callback([options, &chosen] { chosen = [options] { return show_config(*options); }; });
}

}  // namespace rptv
