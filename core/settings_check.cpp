// SPDX-License-Identifier: MIT
// Checks of settings values and the words of their errors.
#include "core/settings_check.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

#include "core/quote.hpp"
#include "core/utf8.hpp"

namespace rptv {
namespace {

template <class Number>
std::string shortest(Number value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

/// Bounds of integers are written as integers: they were given as such.
std::string bound(const Field& field, double value) {
  const bool whole = field.target.index() == 1 && std::fabs(value) < 9e18;
  return whole ? shortest(static_cast<std::int64_t>(value)) : shortest(value);
}

std::string bounds(const Field& field) {
  const bool below = std::isfinite(field.minimum), above = std::isfinite(field.maximum);
  if (below && above) return " from " + bound(field, field.minimum) + " to " + bound(field, field.maximum);
  if (below) return " of at least " + bound(field, field.minimum);
  return above ? " of at most " + bound(field, field.maximum) : "";
}

bool in_bounds(const Field& field, double value) {
  return std::isfinite(value) && value >= field.minimum && value <= field.maximum;
}

/// Well-formed UTF-8 without a null byte: what a TOML string can hold.
bool is_text(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0 || text.front() == '\0') return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string toml_string(std::string_view text) {
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (byte < 0x20 || byte == 0x7f) {
      out += std::string("\\u00") + kHex[byte >> 4] + kHex[byte & 15];
    } else {
      out += c;
    }
  }
  return out + "\"";
}

/// Letters to insert, delete or replace until one word is the other (Levenshtein).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// "linker." of "linker.memory"; empty at the top level.
std::string_view section_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? std::string_view() : path.substr(0, dot + 1);
}

}  // namespace

std::string requirement(const Field& field) {
  switch (field.target.index()) {
    case 0:
      return "true or false";
    case 1:
      return "an integer" + bounds(field);
    case 2:
      return "a finite number" + bounds(field);
    case 3: {
      if (field.choices.empty()) return "a string of UTF-8 text";
      std::string list;
      for (const auto& choice : field.choices) list += (list.empty() ? "'" : ", '") + choice + "'";
      return "one of " + list;
    }
    case 5:
      return "an array of strings";
    default:
      return "an array of " + (field.array_size != 0 ? std::to_string(field.array_size) + " " : std::string()) +
             "finite numbers" + bounds(field);
  }
}

bool fits(const Field& field, const FieldValue& value) {
  if (value.index() != field.target.index()) return false;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return in_bounds(field, static_cast<double>(*integer));
  if (const auto* number = std::get_if<double>(&value)) return in_bounds(field, *number);
  if (const auto* text = std::get_if<std::string>(&value))
    return is_text(*text) && (field.choices.empty() ||
                              std::find(field.choices.begin(), field.choices.end(), *text) != field.choices.end());
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value))
    return std::all_of(texts->begin(), texts->end(), [](const std::string& text) { return is_text(text); });
  if (const auto* array = std::get_if<std::vector<double>>(&value))
    return (field.array_size == 0 || array->size() == field.array_size) &&
           std::all_of(array->begin(), array->end(), [&](double x) { return in_bounds(field, x); });
  return true;
}

FieldValue value_of(const Field& field) {
  return std::visit([](auto* target) { return FieldValue(*target); }, field.target);
}

void assign(const Field& field, FieldValue value) {
  std::visit([&](auto* target) { *target = std::get<std::remove_pointer_t<decltype(target)>>(std::move(value)); },
             field.target);
}

std::string toml_literal(const FieldValue& value) {
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return shortest(*integer);
  if (const auto* text = std::get_if<std::string>(&value)) return toml_string(*text);
  const auto number_literal = [](double number) {
    const std::string digits = shortest(number);
    return digits.find_first_of(".en") == std::string::npos ? digits + ".0" : digits;
  };
  if (const auto* number = std::get_if<double>(&value)) return number_literal(*number);
  std::string list = "[";
  if (const auto* texts = std::get_if<std::vector<std::string>>(&value)) {
    for (const auto& each : *texts) list += (list.size() > 1 ? ", " : "") + toml_string(each);
    return list + "]";
  }
  for (const double number : std::get<std::vector<double>>(value))
    list += (list.size() > 1 ? ", " : "") + number_literal(number);
  return list + "]";
}

std::string unknown_key(const FieldList& fields, std::string_view path) {
  constexpr std::size_t kLongest = 200;  // of a key that is worth comparing
  const std::string_view section = section_of(path);
  const std::string_view leaf = path.substr(section.size());
  std::string_view nearest;
  std::size_t best = std::max<std::size_t>(2, std::min(path.size(), kLongest) / 4) + 1;
  std::string siblings, sections;
  for (const auto& field : fields.all()) {
    const std::string_view known = field.path, known_section = section_of(known);
    const bool only_misplaced = known.substr(known_section.size()) == leaf;
    const std::size_t distance = only_misplaced ? 1 : path.size() > kLongest ? best : edit_distance(path, known);
    if (distance < best) {
      best = distance;
      nearest = known;
    }
    if (known_section == section) siblings += (siblings.empty() ? "" : ", ") + field.path.substr(section.size());
    const std::string top = field.path.substr(0, field.path.find('.'));
    if ((", " + sections + ", ").find(", " + top + ", ") == std::string::npos)
      sections += (sections.empty() ? "" : ", ") + top;
  }
  const std::string head = "unknown key " + in_quotes(path, kLongest);
  if (nearest.empty()) return head + "; remove it, known are: " + (siblings.empty() ? sections : siblings);
  const std::string_view shown = section_of(nearest) == section ? nearest.substr(section.size()) : nearest;
  return head + " (did you mean '" + std::string(shown) + "'?)";
}

}  // namespace rptv
