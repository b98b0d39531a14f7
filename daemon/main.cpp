// SPDX-License-Identifier: MIT
// The one binary: parses the command line and runs the chosen command.
#include <CLI/CLI.hpp>
#include <iostream>

#include "daemon/commands/command.hpp"

int main(int argc, char** argv) {
  CLI::App app{"rapidptv: real-time 3D particle tracking", "rapidptv"};
  app.require_subcommand(1);
  rptv::Action chosen;
  try {
    app.parse(argc, argv);
    return static_cast<int>(chosen());
  } catch (const CLI::Success& e) {
    return app.exit(e);
  } catch (const CLI::Error& e) {
    app.exit(e);
    return static_cast<int>(rptv::ExitCode::usage);
  } catch (const rptv::Error& e) {
    std::cerr << "rapidptv: " << e.what() << '\n';
    return static_cast<int>(e.code());
  } catch (const std::exception& e) {
    std::cerr << "rapidptv: internal error: " << e.what() << "; please report it with the command line\n";
    return static_cast<int>(rptv::ExitCode::internal);
  }
}
