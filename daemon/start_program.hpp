// SPDX-License-Identifier: MIT
// How one of rapidptv's executables becomes another.
#pragma once

namespace rptv {

/// Replaces this process by `program`, which lies beside it (in a build tree, or both in libexec) or in libexec.
/// `arguments`: main()'s. Returns only when it cannot: an exit code, after a line on stderr. Main thread.
int start_program(const char* program, char** arguments);

}  // namespace rptv
