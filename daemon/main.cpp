// SPDX-License-Identifier: MIT
// The one binary: parses the command line and runs the chosen command.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>

#include "daemon/commands/command.hpp"

namespace {

void add_commands(CLI::App& app, rptv::Action& chosen) {
  for (const auto add :
       {rptv::add_run, rptv::add_check, rptv::add_show_config, rptv::add_calibrate, rptv::add_reconstruct,
        rptv::add_link, rptv::add_simulate, rptv::add_score, rptv::add_info, rptv::add_tail, rptv::add_demo,
        rptv::add_cameras, rptv::add_snapshot, rptv::add_doctor, rptv::add_bench})
    add(app, chosen);
}

/// OpenMP's workers would spin between frames, on cores that the other stages need. The runtime reads its environment
/// only while it is loaded, so the process starts once more with the variable set.
void let_openmp_sleep(char** argv) {
  if (getenv("OMP_WAIT_POLICY") != nullptr) return;
  setenv("OMP_WAIT_POLICY", "passive", 1);
  execv("/proc/self/exe", argv);  // returns only on failure: then it works as well, with spinning workers
}

}  // namespace

int main(int argc, char** argv) {
  let_openmp_sleep(argv);
  CLI::App app{"rapidptv: real-time 3D particle tracking", "rapidptv"};
  app.set_version_flag("--version", RPTV_VERSION);
  app.require_subcommand(1);
  rptv::Action chosen;
  add_commands(app, chosen);
  try {
    app.parse(argc, argv);
    return static_cast<int>(chosen());
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(rptv::ExitCode::usage);
  } catch (const rptv::Error& e) {
    std::cerr << "rapidptv: " << e.what() << '\n';
    return static_cast<int>(e.code());
  } catch (const std::exception& e) {
    std::cerr << "rapidptv: internal error: " << e.what() << "; please report it with the command line\n";
    return static_cast<int>(rptv::ExitCode::internal);
  }
}
