// SPDX-License-Identifier: MIT
// Lists of settings fields, single assignments, and the fields as TOML text.
#include "core/settings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/error.hpp"
#include "core/quote.hpp"
#include "core/settings_check.hpp"

namespace rptv {
namespace {

std::string_view trim(std::string_view text) noexcept {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

template <class Number>
bool parse(std::string_view text, Number& value) {
  text = trim(text);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

/// Elements between commas; quotes round one are optional and keep a comma in it.
bool parse_texts(std::string_view text, std::vector<std::string>& values) {
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  text = trim(text);
  if (text.empty()) return true;
  while (true) {
    text = trim(text);
    const bool quoted = text.starts_with('"');
    const std::size_t stop = quoted ? text.find('"', 1) : text.find(',');
    if (quoted && stop == std::string_view::npos) return false;
    values.emplace_back(quoted ? text.substr(1, stop - 1) : trim(text.substr(0, stop)));
    text = trim(text.substr(std::min(text.size(), quoted ? stop + 1 : stop)));
    if (text.empty()) return true;
    if (text.front() != ',') return false;
    text.remove_prefix(1);
  }
}

bool parse_numbers(std::string_view text, std::vector<double>& values) {
  if (text.starts_with('[') && text.ends_with(']')) text = text.substr(1, text.size() - 2);
  if (text.find_first_not_of(' ') == std::string_view::npos) return true;
  while (true) {
    const std::size_t comma = text.find(',');
    if (!parse(text.substr(0, comma), values.emplace_back())) return false;
    if (comma == std::string_view::npos) return true;
    text.remove_prefix(comma + 1);
  }
}

/// `text` as the kind of value that the field holds; false when it is none.
bool parse_value(const Field& field, std::string_view text, FieldValue& value) {
  switch (field.target.index()) {
    case 0:
      value = text == "true";
      return text == "true" || text == "false";
    case 1:
      return parse(text, value.emplace<std::int64_t>());
    case 2:
      return parse(text, value.emplace<double>());
    case 3:
      if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
      value = std::string(text);
      return true;
    case 5:
      return parse_texts(text, value.emplace<std::vector<std::string>>());
    default:
      return parse_numbers(text, value.emplace<std::vector<double>>());
  }
}

bool is_finite(const FieldValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return std::isfinite(*number);
  const auto* array = std::get_if<std::vector<double>>(&value);
  return array == nullptr || std::all_of(array->begin(), array->end(), [](double x) { return std::isfinite(x); });
}

std::string section_of(const Field& field) {
  const std::size_t dot = field.path.rfind('.');
  return dot == std::string::npos ? std::string() : field.path.substr(0, dot);
}

/// Comment and assignment of one field. A value that TOML files may not give (not finite: "unset") is only mentioned.
std::string toml_lines(const Field& field) {
  const FieldValue value = value_of(field);
  const std::string name = field.path.substr(field.path.rfind('.') + 1);
  const bool any_text = std::holds_alternative<std::string*>(field.target) && field.choices.empty();
  const bool evident = any_text || std::holds_alternative<bool*>(field.target);
  std::string text = "# " + field.doc + (field.required ? " (required)\n" : "\n");
  if (!evident) text += "#   " + requirement(field) + "\n";
  if (!is_finite(value)) text += "# ";
  return text + name + " = " + toml_literal(value) + "\n";
}

}  // namespace

Field& FieldList::add(std::string_view name, decltype(Field::target) target, std::string_view doc) {
  Field field;
  field.path = prefix_ + std::string(name);
  field.target = target;
  field.doc = doc;
  for (const auto& known : fields_)
    if (known.path == field.path) throw Error(ExitCode::internal, "two settings are named '" + field.path + "'");
  return fields_.emplace_back(std::move(field));
}

Field& FieldList::number(std::string_view name, double& target, double minimum, double maximum, std::string_view doc) {
  Field& field = add(name, &target, doc);
  field.minimum = minimum;
  field.maximum = maximum;
  return field;
}

Field& FieldList::integer(std::string_view name, std::int64_t& target, std::int64_t minimum, std::int64_t maximum,
                          std::string_view doc) {
  Field& field = add(name, &target, doc);
  field.minimum = static_cast<double>(minimum);
  field.maximum = static_cast<double>(maximum);
  return field;
}

Field& FieldList::flag(std::string_view name, bool& target, std::string_view doc) { return add(name, &target, doc); }

Field& FieldList::text(std::string_view name, std::string& target, std::string_view doc) {
  return add(name, &target, doc);
}

Field& FieldList::choice(std::string_view name, std::string& target, std::vector<std::string> choices,
                         std::string_view doc) {
  Field& field = add(name, &target, doc);
  field.choices = std::move(choices);
  return field;
}

Field& FieldList::numbers(std::string_view name, std::vector<double>& target, std::size_t size, double minimum,
                          double maximum, std::string_view doc) {
  Field& field = add(name, &target, doc);
  field.array_size = size;
  field.minimum = minimum;
  field.maximum = maximum;
  return field;
}

Field& FieldList::texts(std::string_view name, std::vector<std::string>& target, std::string_view doc) {
  return add(name, &target, doc);
}

void set_field(FieldList& fields, std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  const auto refuse = [&](const std::string& text) {
    throw Error(ExitCode::usage, "--set " + in_quotes(assignment, 200) + ": " + text);
  };
  if (equals == std::string_view::npos) refuse("has no '='; write key=value, for instance linker.memory=3");
  const std::string_view key = assignment.substr(0, equals), text = assignment.substr(equals + 1);
  const auto& all = fields.all();
  const auto field = std::find_if(all.begin(), all.end(), [&](const Field& known) { return known.path == key; });
  if (field == all.end()) refuse(unknown_key(fields, key));
  FieldValue value;
  if (!parse_value(*field, text, value) || !fits(*field, value))
    refuse("'" + field->path + "' must be " + requirement(*field));
  assign(*field, std::move(value));
}

std::string to_toml(const FieldList& fields, std::int64_t schema) {
  std::vector<std::string> sections = {""};
  for (const auto& field : fields.all())
    if (std::find(sections.begin(), sections.end(), section_of(field)) == sections.end())
      sections.push_back(section_of(field));
  std::string text = "schema = " + std::to_string(schema) + "\n";
  for (const auto& section : sections) {
    if (!section.empty()) text += "\n[" + section + "]\n";
    for (const auto& field : fields.all())
      if (section_of(field) == section) text += toml_lines(field);
  }
  return text;
}

}  // namespace rptv
