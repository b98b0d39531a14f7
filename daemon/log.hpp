// SPDX-License-Identifier: MIT
// Where the daemon's talk goes: stderr, in the form that the terminal or the journal reads best.
#pragma once

#include <string>

namespace rptv {

/// Sets spdlog's default logger: stderr, lines prefixed with journald priorities (`<3>` to `<7>`) when the service
/// manager reads them (JOURNAL_STREAM or INVOCATION_ID set and stderr no terminal), else time and level. `level` is one
/// of trace, debug, info, warning, error, off; empty means RPTV_LOG from the environment, else info. Throws
/// Error(usage) for another word. Call once, before other threads log; then use spdlog::info() and its kin. Never on
/// the running path.
void start_log(const std::string& level);

}  // namespace rptv
