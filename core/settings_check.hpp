// SPDX-License-Identifier: MIT
// Values on their way into settings fields: whether they fit, and how to say that they do not. Used by the readers
// only.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

/// Alternatives in the order of Field::target, so that the index of one tells the other.
using FieldValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>, std::vector<std::string>>;

/// What the field takes, for messages: "an integer from 0 to 100", "one of 'newest', 'lossless'".
std::string requirement(const Field& field);

/// Right alternative, finite, in bounds, among the choices, right array size, UTF-8.
bool fits(const Field& field, const FieldValue& value);

/// The value of a field, and the way back; `value` must fit.
FieldValue value_of(const Field& field);
void assign(const Field& field, FieldValue value);

/// The value as TOML writes it; a double always has a point, an exponent or a name so that it stays a double.
std::string toml_literal(const FieldValue& value);

/// "unknown key 'linker.serch_range_mm' (did you mean 'search_range_mm'?)", or the keys known in that section.
std::string unknown_key(const FieldList& fields, std::string_view path);

}  // namespace rptv
