// SPDX-License-Identifier: MIT
// How a subcommand joins the command line: it declares its options and leaves its action in `chosen`.
#pragma once

#include <functional>

#include "core/error.hpp"

namespace CLI {
class App;
}

namespace rptv {

/// What the user asked for; main() runs it after parsing. Throws Error for everything the user can mend.
using Action = std::function<ExitCode()>;

void add_run(CLI::App& app, Action& chosen);
void add_check(CLI::App& app, Action& chosen);
void add_show_config(CLI::App& app, Action& chosen);
void add_reconstruct(CLI::App& app, Action& chosen);
void add_calibrate(CLI::App& app, Action& chosen);
void add_link(CLI::App& app, Action& chosen);
void add_simulate(CLI::App& app, Action& chosen);
void add_score(CLI::App& app, Action& chosen);
void add_info(CLI::App& app, Action& chosen);
void add_tail(CLI::App& app, Action& chosen);
void add_demo(CLI::App& app, Action& chosen);
void add_cameras(CLI::App& app, Action& chosen);
void add_snapshot(CLI::App& app, Action& chosen);
void add_doctor(CLI::App& app, Action& chosen);
void add_bench(CLI::App& app, Action& chosen);

}  // namespace rptv
