// SPDX-License-Identifier: MIT
// Parses a command line of subcommands and runs the chosen one; the same for both executables.
#pragma once

#include <span>

#include "daemon/commands/command.hpp"

namespace rptv {

using AddCommand = void (*)(Command app, Action& chosen);

/// Returns the process's exit code. Errors are one line on stderr.
int run_command_line(int argc, char** argv, std::span<const AddCommand> commands);

}  // namespace rptv
