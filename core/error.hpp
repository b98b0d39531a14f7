// SPDX-License-Identifier: MIT
// The one exception type: a text fit for the user and the sysexits code that the process ends with.
#pragma once

#include <stdexcept>
#include <string>

namespace rptv {

/// Exit codes of every command, as in sysexits.h.
enum class ExitCode : int {
  ok = 0,
  usage = 64,
  bad_data = 65,
  no_input = 66,
  unavailable = 69,
  internal = 70,
  io = 74,
  permission = 77,
  configuration = 78,
};

/// Thrown during set-up only; never on the running path. `message` is one line that names the file (and line), the
/// value and the next step, without the program's name in front.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

}  // namespace rptv
