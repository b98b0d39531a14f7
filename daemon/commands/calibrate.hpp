// SPDX-License-Identifier: MIT
// The parts of `rapidptv calibrate`.
#pragma once

#include "daemon/commands/command.hpp"

namespace rptv {

void add_calibrate_cameras(CLI::App& calibrate, Action& chosen);
void add_calibrate_lenslets(CLI::App& calibrate, Action& chosen);
void add_calibrate_volume(CLI::App& calibrate, Action& chosen);
void add_calibrate_points(CLI::App& calibrate, Action& chosen);
void add_calibrate_wand(CLI::App& calibrate, Action& chosen);
void add_calibrate_import(CLI::App& calibrate, Action& chosen);
void add_calibrate_export(CLI::App& calibrate, Action& chosen);

}  // namespace rptv
