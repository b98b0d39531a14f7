// SPDX-License-Identifier: MIT
// The two things that JSON needs care for: strings and numbers.
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

namespace rptv {

/// `text` in quotes, escaped; UTF-8 stays as it is.
inline std::string json_string(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (byte < 0x20)
      out += std::string("\\u00") + kHex[byte >> 4] + kHex[byte & 15];
    else
      out += c;
  }
  return out + "\"";
}

/// The shortest text that reads back as the same double; null for what JSON cannot say.
inline std::string json_number(double value) {
  if (!std::isfinite(value)) return "null";
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

}  // namespace rptv
