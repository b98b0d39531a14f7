// SPDX-License-Identifier: MIT
// rapidptv: links tables by itself, in a moment and in little memory; hands every other command to rapidptv-daemon.
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <string_view>

#include "daemon/command_line.hpp"

namespace {

/// Beside this program in a build tree, in libexec where it is installed.
std::filesystem::path find_daemon() {
  std::error_code error;
  const auto here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  const auto beside = here / "rapidptv-daemon";
  return std::filesystem::exists(beside, error) ? beside : here / RPTV_LIBEXEC_FROM_BIN / "rapidptv-daemon";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "link") {
    constexpr rptv::AddCommand kLink[] = {rptv::add_link};
    return rptv::run_command_line(argc, argv, kLink);
  }
  // OpenMP's workers would spin between frames, on cores that the other stages need: some microseconds, from one loop
  // of a frame to the next, are enough. The runtime reads its environment only while it is loaded.
  setenv("OMP_WAIT_POLICY", "passive", 0);
  setenv("GOMP_SPINCOUNT", "3000", 0);
  const std::filesystem::path daemon = find_daemon();
  execv(daemon.c_str(), argv);
  std::cerr << "rapidptv: cannot start " << daemon.native() << ": " << std::strerror(errno)
            << "; it belongs to rapidptv, install both\n";
  return static_cast<int>(rptv::ExitCode::internal);
}
