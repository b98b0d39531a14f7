// SPDX-License-Identifier: MIT
// rapidptv-daemon: all commands but calibrate, and the libraries that they need. Users start it through rapidptv
// (daemon/main.cpp).
#include <string_view>

#include "daemon/command_line.hpp"
#include "daemon/start_program.hpp"

int main(int argc, char** argv) {
  using namespace rptv;
  if (argc > 1 && std::string_view(argv[1]) == "calibrate") return start_program("rapidptv-calibrate", argv);
  constexpr AddCommand kCommands[] = {add_run,  add_check,    add_show_config, list_calibrate, add_reconstruct,
                                      add_link, add_simulate, add_score,       add_info,       add_tail,
                                      add_demo, add_cameras,  add_snapshot,    add_doctor,     add_bench};
  return run_command_line(argc, argv, kCommands);
}
