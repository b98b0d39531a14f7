// SPDX-License-Identifier: MIT
// Named, bounded, documented fields of aggregate structs: one list per struct serves reading, checking and showing it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rptv {

/// One field of a settings struct. `target` points into the struct, which must outlive the list.
struct Field {
  std::string path;  ///< dotted, units in the name: "linker.search_range_mm"
  std::variant<bool*, std::int64_t*, double*, std::string*, std::vector<double>*, std::vector<std::string>*> target;
  double minimum = -std::numeric_limits<double>::infinity();  ///< inclusive; numbers and elements of arrays
  double maximum = std::numeric_limits<double>::infinity();   ///< inclusive
  std::vector<std::string> choices;                           ///< strings: allowed values; empty: any
  std::string doc;                                            ///< one line: meaning and unit
  std::size_t array_size = 0;                                 ///< arrays: required length; 0: any
  bool required = false;                                      ///< a file without it is an error
};

/// Collects fields; `section` nests a struct that has `template <…> void fields(FieldList&)`-like listing.
///
///     struct LinkerSettings {
///       double search_range_mm = 0.5;
///       void fields(FieldList& list) { list.number("search_range_mm", search_range_mm, 1e-9, 1e6, "…"); }
///     };
class FieldList {
 public:
  Field& number(std::string_view name, double& target, double minimum, double maximum, std::string_view doc);
  Field& integer(std::string_view name, std::int64_t& target, std::int64_t minimum, std::int64_t maximum,
                 std::string_view doc);
  Field& flag(std::string_view name, bool& target, std::string_view doc);
  Field& text(std::string_view name, std::string& target, std::string_view doc);
  Field& choice(std::string_view name, std::string& target, std::vector<std::string> choices, std::string_view doc);
  Field& numbers(std::string_view name, std::vector<double>& target, std::size_t size, double minimum, double maximum,
                 std::string_view doc);
  Field& texts(std::string_view name, std::vector<std::string>& target, std::string_view doc);

  template <class Settings>
  void section(std::string_view name, Settings& settings) {
    const std::string outer = prefix_;
    prefix_ += std::string(name) + ".";
    settings.fields(*this);
    prefix_ = outer;
  }

  /// For files that may be partial: nothing is an error by being absent.
  void require_nothing() noexcept {
    for (auto& field : fields_) field.required = false;
  }

  const std::vector<Field>& all() const noexcept { return fields_; }

 private:
  Field& add(std::string_view name, decltype(Field::target) target, std::string_view doc);
  std::string prefix_;
  std::vector<Field> fields_;
};

/// Reads a TOML file into the fields. Errors (code configuration, or no_input when the file is missing) name
/// `file:line:column`, the dotted key, the value and the next step; unknown keys get "did you mean". NaN and infinity
/// are refused. `kind` names the file's purpose in messages; `schema` is the highest top-level `schema` number accepted
/// (a newer one is an error that says to update rapidptv). Set-up only.
void read_toml_file(const std::filesystem::path& file, std::string_view kind, std::int64_t schema, FieldList& fields);

/// The same from text; `origin` stands for the file's name in messages.
void read_toml_text(std::string_view text, const std::string& origin, std::string_view kind, std::int64_t schema,
                    FieldList& fields);

/// Sets one field from `key=value` (a command line's --set), with the same checks; throws Error(usage).
void set_field(FieldList& fields, std::string_view assignment);

/// The fields as TOML text with the docs as comments; read_toml_text() of it gives the same values back bit for bit.
std::string to_toml(const FieldList& fields, std::int64_t schema);

}  // namespace rptv
