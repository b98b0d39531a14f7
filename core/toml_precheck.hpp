// SPDX-License-Identifier: MIT
// Refuses TOML texts that toml++ 3.3 cannot take: it reaches undefined behaviour on some, and exhausts the stack on
// others.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace rptv {

/// What is wrong with a text and where; columns count characters from 1.
struct TomlObjection {
  std::size_t line = 1;
  std::size_t column = 1;
  std::string text;
};

/// Looks for what toml++ must not be given: bytes that are not UTF-8, characters beyond ASCII outside of strings and
/// comments or behind a line-ending backslash (its issues 190 and 295: unreachable code is reached), and keys of more
/// than 32 parts (recursion). The first objection, or none.
std::optional<TomlObjection> precheck_toml(std::string_view text);

}  // namespace rptv
