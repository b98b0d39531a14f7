// SPDX-License-Identifier: MIT
// Looks for the executable where builds and installations put it.
#include "daemon/start_program.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "core/error.hpp"

namespace rptv {

int start_program(const char* program, char** arguments) {
  std::error_code error;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  auto path = here / program;
  if (!std::filesystem::exists(path, error)) path = here / RPTV_LIBEXEC_FROM_BIN / program;
  execv(path.c_str(), arguments);
  std::cerr << "rapidptv: cannot start " << path.native() << ": " << std::strerror(errno)
            << "; it belongs to rapidptv, install both\n";
  return static_cast<int>(ExitCode::internal);
}

}  // namespace rptv
