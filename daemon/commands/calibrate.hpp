// SPDX-License-Identifier: MIT
// The parts of `rapidptv calibrate`.
#pragma once

#include "daemon/commands/command.hpp"

namespace rptv {

/// The command's name and summary, without its parts.
Command calibrate_command(Command app);

void add_calibrate_cameras(Command calibrate, Action& chosen);
void add_calibrate_lenslets(Command calibrate, Action& chosen);
void add_calibrate_volume(Command calibrate, Action& chosen);
void add_calibrate_points(Command calibrate, Action& chosen);
void add_calibrate_wand(Command calibrate, Action& chosen);
void add_calibrate_refine(Command calibrate, Action& chosen);
void add_calibrate_import(Command calibrate, Action& chosen);
void add_calibrate_export(Command calibrate, Action& chosen);

}  // namespace rptv
