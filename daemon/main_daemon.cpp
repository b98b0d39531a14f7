// SPDX-License-Identifier: MIT
// rapidptv-daemon: all commands, and all libraries that they need. Users start it through rapidptv (daemon/main.cpp).
#include "daemon/command_line.hpp"

int main(int argc, char** argv) {
  using namespace rptv;
  constexpr AddCommand kCommands[] = {add_run,  add_check,    add_show_config, add_calibrate, add_reconstruct,
                                      add_link, add_simulate, add_score,       add_info,      add_tail,
                                      add_demo, add_cameras,  add_snapshot,    add_doctor,    add_bench};
  return run_command_line(argc, argv, kCommands);
}
