// SPDX-License-Identifier: MIT
// TOML into settings fields; the only translation unit that sees toml++.
#include <algorithm>
#include <utility>

// toml++ 3.3 asserts (or, in clang's release builds, assumes) that a key begins with a key's character and then reports
// as an error when it does not: without the assertions it does what it should.
#define TOML_HEADER_ONLY 1
#define TOML_ASSERT(expression) static_assert(true)
#include <toml++/impl/preprocessor.h>
#undef TOML_ASSUME
#define TOML_ASSUME(...) static_assert(true)
#include <toml++/toml.h>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/settings.hpp"
#include "core/settings_check.hpp"
#include "core/text_file.hpp"
#include "core/toml_precheck.hpp"

namespace rptv {
namespace {

/// One read of one text: where it came from, where it goes, and what was found so far. Fields change only at the end.
class TomlReading {
 public:
  TomlReading(const std::string& origin, std::string_view kind, std::int64_t schema, const FieldList& fields)
      : origin_(origin), kind_(kind), schema_(schema), fields_(fields) {}

  void read(std::string_view text) {
    if (const auto objection = precheck_toml(text))
      throw Error(ExitCode::configuration, origin_ + ":" + std::to_string(objection->line) + ":" +
                                               std::to_string(objection->column) + ": " + objection->text);
    toml::table root;
    try {
      root = toml::parse(text, origin_);
    } catch (const toml::parse_error& e) {
      std::string what(e.description());
      std::replace_if(
          what.begin(), what.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
      refuse(e.source(), "no valid TOML: " + what + "; mend this line");
    }
    check_schema(root);
    collect(root, "");
    check_required(root);
    for (auto& [field, value] : found_) assign(*field, std::move(value));
  }

 private:
  [[noreturn]] void refuse(const toml::source_region& where, const std::string& text) const {
    throw Error(ExitCode::configuration, origin_ + ":" + std::to_string(where.begin.line) + ":" +
                                             std::to_string(where.begin.column) + ": " + text);
  }

  void check_schema(toml::table& root) const {
    const toml::node* node = root.get("schema");
    if (node == nullptr) return;
    const auto* number = node->as_integer();
    if (number == nullptr || number->get() < 1)
      refuse(node->source(), "'schema' is " + describe(*node) + "; it must be an integer of at least 1");
    if (number->get() > schema_)
      refuse(node->source(), "schema " + std::to_string(number->get()) + " of this " + std::string(kind_) +
                                 " is newer than " + std::to_string(schema_) +
                                 ", the newest that this rapidptv reads; update rapidptv");
    root.erase("schema");
  }

  void collect(const toml::table& table, const std::string& prefix) {
    for (const auto& [key, node] : table) {
      const std::string path = prefix + std::string(key.str());
      const auto& all = fields_.all();
      const auto field = std::find_if(all.begin(), all.end(), [&](const Field& f) { return f.path == path; });
      if (field != all.end()) {
        collect_value(*field, node);
      } else if (!is_section(path)) {
        refuse(key.source(), unknown_key(fields_, path));
      } else if (const auto* section = node.as_table()) {
        collect(*section, path + ".");
      } else {
        refuse(node.source(), in_quotes(path) + " is " + describe(node) + "; it must be a section [" + path + "]");
      }
    }
  }

  void collect_value(const Field& field, const toml::node& node) {
    FieldValue value;
    if (!convert(field, node, value) || !fits(field, value))
      refuse(node.source(), in_quotes(field.path) + " is " + describe(node) + "; it must be " + requirement(field));
    found_.emplace_back(&field, std::move(value));
  }

  void check_required(const toml::table& root) const {
    for (const auto& field : fields_.all()) {
      const auto is_field = [&](const auto& entry) { return entry.first == &field; };
      if (!field.required || std::any_of(found_.begin(), found_.end(), is_field)) continue;
      const std::string text = "'" + field.path + "' is missing (" + field.doc + "); add it, " + requirement(field);
      const std::size_t dot = field.path.rfind('.');
      if (dot != std::string::npos)
        if (const auto section = root.at_path(field.path.substr(0, dot)); section && section.node()->source().begin)
          refuse(section.node()->source(), text);
      throw Error(ExitCode::configuration, origin_ + ": " + text);
    }
  }

  bool is_section(const std::string& path) const {
    const auto& all = fields_.all();
    return std::any_of(all.begin(), all.end(), [&](const Field& f) { return f.path.starts_with(path + "."); });
  }

  /// Integers are numbers too; nothing else changes its type.
  static bool convert(const Field& field, const toml::node& node, FieldValue& value) {
    switch (field.target.index()) {
      case 0:
        return take<bool>(node, value);
      case 1:
        return take<std::int64_t>(node, value);
      case 2:
        return take_number(node, value.emplace<double>());
      case 3:
        return take<std::string>(node, value);
      case 5: {
        const auto* array = node.as_array();
        auto& texts = value.emplace<std::vector<std::string>>();
        return array != nullptr && std::all_of(array->begin(), array->end(), [&](const toml::node& element) {
                 const auto text = element.value_exact<std::string>();
                 if (text) texts.push_back(*text);
                 return text.has_value();
               });
      }
      default: {
        const auto* array = node.as_array();
        auto& numbers = value.emplace<std::vector<double>>();
        return array != nullptr && std::all_of(array->begin(), array->end(), [&](const toml::node& element) {
                 return take_number(element, numbers.emplace_back());
               });
      }
    }
  }

  template <class T>
  static bool take(const toml::node& node, FieldValue& value) {
    const auto exact = node.value_exact<T>();
    if (exact) value = *exact;
    return exact.has_value();
  }

  static bool take_number(const toml::node& node, double& value) {
    if (const auto* number = node.as_floating_point()) value = number->get();
    if (const auto* integer = node.as_integer()) value = static_cast<double>(integer->get());
    return node.is_number();
  }

  static std::string describe(const toml::node& node) {
    FieldValue value;
    if (const auto* text = node.as_string()) return in_quotes(text->get());
    if (node.is_table()) return "a section";
    if (const auto* array = node.as_array()) return "an array of " + std::to_string(array->size()) + " values";
    if (take<bool>(node, value) || take<std::int64_t>(node, value) || take<double>(node, value))
      return toml_literal(value);
    return "a date or time";
  }

  const std::string& origin_;
  std::string_view kind_;
  std::int64_t schema_;
  const FieldList& fields_;
  std::vector<std::pair<const Field*, FieldValue>> found_;
};

}  // namespace

void read_toml_text(std::string_view text, const std::string& origin, std::string_view kind, std::int64_t schema,
                    FieldList& fields) {
  TomlReading(origin, kind, schema, fields).read(text);
}

void read_toml_file(const std::filesystem::path& file, std::string_view kind, std::int64_t schema, FieldList& fields) {
  const std::string text = read_text_file(file, "give the path of a " + std::string(kind) + " file (TOML)");
  read_toml_text(text, file.string(), kind, schema, fields);
}

}  // namespace rptv
