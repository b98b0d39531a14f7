// SPDX-License-Identifier: MIT
// `rapidptv calibrate`: cameras, lenslets, volume, wand, particles, and rigs of other programs.
#include "daemon/commands/calibrate.hpp"

namespace rptv {

void add_calibrate(Command app, Action& chosen) {
  Command command = calibrate_command(app);
  command.require_subcommand();
  command.footer(
      "Examples:\n"
      "  rapidptv calibrate cameras charuco/ --board board.toml -o rig.toml --report report/\n"
      "  rapidptv calibrate lenslets white.png --start sheet.toml -o cal.toml\n"
      "  rapidptv calibrate volume pairs.csv --calibration cal.toml -o volume.toml\n"
      "  rapidptv calibrate wand ends/ --start rig.toml --length 100 -o better.toml\n"
      "  rapidptv calibrate refine frames/ --start rig.toml -o better.toml\n"
      "  rapidptv calibrate import openptv test_cavity -o rig.toml");
  add_calibrate_cameras(command, chosen);
  add_calibrate_lenslets(command, chosen);
  add_calibrate_volume(command, chosen);
  add_calibrate_points(command, chosen);
  add_calibrate_wand(command, chosen);
  add_calibrate_refine(command, chosen);
  add_calibrate_import(command, chosen);
  add_calibrate_export(command, chosen);
}

}  // namespace rptv
