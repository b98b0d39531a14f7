// SPDX-License-Identifier: MIT
// `rapidptv calibrate` as `rapidptv --help` lists it: the command itself is in rapidptv-calibrate.
#include "daemon/commands/calibrate.hpp"

namespace rptv {

Command calibrate_command(Command app) {
  return app.add_subcommand("calibrate", "Make a calibration from images or points, or from another program's");
}

void list_calibrate(Command app, Action&) { calibrate_command(app); }

}  // namespace rptv
