// SPDX-License-Identifier: MIT
// How values from outside appear in messages: in quotes, on one line, shortened.
#pragma once

#include <string>
#include <string_view>

namespace rptv {

/// 'value' with control characters replaced by '?' and everything after `limit` bytes by "…".
inline std::string in_quotes(std::string_view value, std::size_t limit = 60) {
  std::string text = "'";
  for (const char c : value.substr(0, limit)) text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
  // a multi-byte character that the cut goes through is dropped whole
  if (value.size() > limit) {
    while (text.size() > 1 && (static_cast<unsigned char>(text.back()) & 0xC0) == 0x80) text.pop_back();
    if (text.size() > 1 && static_cast<unsigned char>(text.back()) >= 0xC0) text.pop_back();
    text += "…";
  }
  return text + "'";
}

}  // namespace rptv
