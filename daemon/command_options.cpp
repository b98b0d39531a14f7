// SPDX-License-Identifier: MIT
// The one source that compiles CLI11; each kind of value that options take is listed here.
#include "daemon/command_options.hpp"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>

namespace rptv {

Option Option::required() {
  option_->required();
  return *this;
}

Option Option::expected(int values) {
  option_->expected(values);
  return *this;
}

Option Option::expected(int least, int most) {
  option_->expected(least, most);
  return *this;
}

Option Option::each_time(int values) {
  option_->type_size(values)->expected(1, CLI::detail::expected_max_vector_size)->allow_extra_args(false);
  return *this;
}

Option Option::delimiter(char between_values) {
  option_->delimiter(between_values);
  return *this;
}

Option Option::allow_extra_args(bool allowed) {
  option_->allow_extra_args(allowed);
  return *this;
}

Option Option::show_default() {
  option_->capture_default_str();
  return *this;
}

Option Option::needs(Option other) {
  option_->needs(other.option_);
  return *this;
}

Option Option::excludes(const char* other) {
  option_->excludes(other);
  return *this;
}

Option Option::one_of(std::initializer_list<std::string> values) {
  option_->check(CLI::IsMember(std::vector<std::string>(values)));
  return *this;
}

Option Option::positive() {
  option_->check(CLI::PositiveNumber);
  return *this;
}

template <class T>
Option Option::range(T least, T most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

template Option Option::range(double, double);
template Option Option::range(int, int);
template Option Option::range(std::int64_t, std::int64_t);
template Option Option::range(std::size_t, std::size_t);

Command Command::add_subcommand(const char* name, const char* what) {
  return Command(*app_->add_subcommand(name, what));
}

template <class T>
Option Command::add_option(const char* name, T& value, const char* what) {
  return Option(*app_->add_option(name, value, what));
}

template Option Command::add_option(const char*, int&, const char*);
template Option Command::add_option(const char*, unsigned&, const char*);
template Option Command::add_option(const char*, std::int64_t&, const char*);
template Option Command::add_option(const char*, std::size_t&, const char*);
template Option Command::add_option(const char*, double&, const char*);
template Option Command::add_option(const char*, std::string&, const char*);
template Option Command::add_option(const char*, std::filesystem::path&, const char*);
template Option Command::add_option(const char*, std::vector<int>&, const char*);
template Option Command::add_option(const char*, std::vector<double>&, const char*);
template Option Command::add_option(const char*, std::vector<std::string>&, const char*);
template Option Command::add_option(const char*, std::vector<std::filesystem::path>&, const char*);

Option Command::add_flag(const char* name, bool& value, const char* what) {
  return Option(*app_->add_flag(name, value, what));
}

void Command::require_subcommand() { app_->require_subcommand(1); }

void Command::footer(const char* text) { app_->footer(text); }

void Command::callback(std::function<void()> action) { app_->callback(std::move(action)); }

}  // namespace rptv
