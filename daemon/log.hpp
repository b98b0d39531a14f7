// SPDX-License-Identifier: MIT
// Where the daemon's talk goes: stderr, in the form that the terminal or the journal reads best.
#pragma once

#include <string>

namespace rptv {

/// Sets spdlog's default logger: stderr; lines begin with a journald priority (`<3>` error to `<7>` debug) when stderr
/// is the journal's own stream (JOURNAL_STREAM names it), else with time and level. `level` is one of trace, debug,
/// info, warning, error, off; empty means RPTV_LOG from the environment, else info. Throws Error(usage) for another
/// word. Call it once, before other threads log; then use spdlog::info() and its kin. Never on the running path.
void start_log(const std::string& level);

}  // namespace rptv
