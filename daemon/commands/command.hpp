// SPDX-License-Identifier: MIT
// How a subcommand joins the command line: it declares its options and leaves its action in `chosen`.
#pragma once

#include <functional>

#include "core/error.hpp"
#include "daemon/command_options.hpp"

namespace rptv {

/// What the user asked for; main() runs it after parsing. Throws Error for everything the user can mend.
using Action = std::function<ExitCode()>;

void add_run(Command app, Action& chosen);
void add_check(Command app, Action& chosen);
void add_show_config(Command app, Action& chosen);
void add_reconstruct(Command app, Action& chosen);
void add_calibrate(Command app, Action& chosen);
void list_calibrate(Command app, Action& chosen);  ///< in --help only
void add_link(Command app, Action& chosen);
void add_simulate(Command app, Action& chosen);
void add_score(Command app, Action& chosen);
void add_info(Command app, Action& chosen);
void add_tail(Command app, Action& chosen);
void add_demo(Command app, Action& chosen);
void add_cameras(Command app, Action& chosen);
void add_snapshot(Command app, Action& chosen);
void add_doctor(Command app, Action& chosen);
void add_bench(Command app, Action& chosen);

}  // namespace rptv
