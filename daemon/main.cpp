// SPDX-License-Identifier: MIT
// rapidptv: links tables by itself, in a moment and in little memory; hands `calibrate` to rapidptv-calibrate, and
// every other command to rapidptv-daemon.
#include <cstdlib>
#include <string_view>

#include "daemon/command_line.hpp"
#include "daemon/start_program.hpp"

int main(int argc, char** argv) {
  const std::string_view command = argc > 1 ? argv[1] : "";
  if (command == "link") {
    constexpr rptv::AddCommand kLink[] = {rptv::add_link};
    return rptv::run_command_line(argc, argv, kLink);
  }
  // OpenMP's workers would spin between frames, on cores that the other stages need: some 0.1 ms, from one loop of
  // a frame to the next, are enough. The runtime reads its environment only while it is loaded.
  setenv("OMP_WAIT_POLICY", "passive", 0);
  setenv("GOMP_SPINCOUNT", "10000", 0);
  return rptv::start_program(command == "calibrate" ? "rapidptv-calibrate" : "rapidptv-daemon", argv);
}
