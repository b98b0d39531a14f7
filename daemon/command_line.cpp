// SPDX-License-Identifier: MIT
// CLI11 and the exit codes behind daemon/command_line.hpp.
#include "daemon/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "core/quote.hpp"

namespace rptv {

int run_command_line(int argc, char** argv, std::span<const AddCommand> commands) {
  CLI::App app{"rapidptv: real-time 3D particle tracking", "rapidptv"};
  app.set_version_flag("--version", RPTV_VERSION);
  app.require_subcommand(1);
  Action chosen;
  for (const AddCommand add : commands) add(Command(app), chosen);
  const auto known = app.get_subcommands({});
  if (argc > 1 && argv[1][0] != '-' &&
      std::none_of(known.begin(), known.end(), [&](const CLI::App* c) { return c->get_name() == argv[1]; })) {
    std::cerr << "rapidptv: there is no command " << in_quotes(argv[1]) << "; `rapidptv --help` lists them\n";
    return static_cast<int>(ExitCode::usage);
  }
  try {
    app.parse(argc, argv);
    return static_cast<int>(chosen());
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::usage);
  } catch (const Error& e) {
    std::cerr << "rapidptv: " << e.what() << '\n';
    return static_cast<int>(e.code());
  } catch (const std::exception& e) {
    std::cerr << "rapidptv: internal error: " << e.what() << "; please report it with the command line\n";
    return static_cast<int>(ExitCode::internal);
  }
}

}  // namespace rptv
