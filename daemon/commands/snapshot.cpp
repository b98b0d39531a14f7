// SPDX-License-Identifier: MIT
// `rapidptv snapshot`: one image of each camera, in its full depth.
#include <iostream>

#include "daemon/commands/command.hpp"
#include "daemon/snapshot.hpp"

namespace rptv {
namespace {

struct SnapshotOptions {
  std::string config, out;
  std::vector<std::string> set;
  double patience_s = 10;
  bool json = false;
};

ExitCode snapshot(const SnapshotOptions& options) {
  const auto all = take_snapshots(load_config(options.config, options.set), options.out,
                                  static_cast<std::int64_t>(options.patience_s * 1e9));
  for (const Snapshot& one : all) std::cout << (options.json ? to_json(one) : to_text(one)) << "\n";
  std::cout << std::flush;
  return ExitCode::ok;
}

}  // namespace

void add_snapshot(Command app, Action& chosen) {
  auto options = std::make_shared<SnapshotOptions>();
  Command command = app.add_subcommand("snapshot", "Write one image of each camera, and say how it is exposed");
  command.add_option("-c,--config,config", options->config, "configuration (TOML)").required();
  command.add_option("-o,--out", options->out, "folder, or PNG file; else CAMERA.png in the working directory");
  command.add_option("--set", options->set, "override one setting: key=value").allow_extra_args(false);
  command.add_option("--patience", options->patience_s, "seconds to wait for an image")
      .range(0.001, 3600.0)
      .show_default();
  command.add_flag("--json", options->json, "print one JSON object a camera");
  command.footer(
      "Prints file, depth, least, greatest and mean grey value, saturated share, time and settings of each camera.\n"
      "Examples:\n"
      "  rapidptv snapshot rig.toml -o focus.png\n"
      "  rapidptv snapshot rig.toml --set aravis.exposure_us=500 --json | jq .saturated");
  command.callback([options, &chosen] { chosen = [options] { return snapshot(*options); }; });
}

}  // namespace rptv
