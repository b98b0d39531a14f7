// SPDX-License-Identifier: MIT
// How commands declare their options. CLI11 does the work, behind these handles: one source compiles it, not every
// command.
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rptv {

/// One option of a command. A handle: copies mean the same option. Each call returns it, so that they chain.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}
  Option required();
  Option expected(int values);
  Option expected(int least, int most);
  Option each_time(int values);  ///< exactly so many, each time that it is given; of a vector
  Option delimiter(char between_values);
  Option allow_extra_args(bool allowed);  ///< false: one value each time that it is given
  Option show_default();                  ///< in --help
  Option needs(Option other);
  Option excludes(const char* other);
  Option one_of(std::initializer_list<std::string> values);
  Option positive();
  /// Bounds included. T: double, int, std::int64_t, std::size_t.
  template <class T>
  Option range(T least, T most);

 private:
  CLI::Option* option_;
};

/// A command, or a command of a command. A handle, valid until the command line has been run. Set-up, main thread.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}
  Command add_subcommand(const char* name, const char* what);
  /// `value` must outlive the parsing. T: a number, std::string, path, or a vector of them, as listed in
  /// command_options.cpp; the linker says when one is missing there.
  template <class T>
  Option add_option(const char* name, T& value, const char* what);
  Option add_flag(const char* name, bool& value, const char* what);
  void require_subcommand();
  void footer(const char* text);
  /// What happens when the command was given and its options are right.
  void callback(std::function<void()> action);

 private:
  CLI::App* app_;
};

}  // namespace rptv
