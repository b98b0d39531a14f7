// SPDX-License-Identifier: MIT
// File names as people number them: frame_9 before frame_10.
#pragma once

#include <cctype>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rptv {

inline bool is_digit(char c) noexcept { return c >= '0' && c <= '9'; }

/// The digits at `at` without leading zeros; moves `at` behind them.
inline std::string_view take_number(std::string_view text, std::size_t& at) noexcept {
  while (at < text.size() && text[at] == '0') ++at;
  const std::size_t begin = at;
  while (at < text.size() && is_digit(text[at])) ++at;
  return text.substr(begin, at - begin);
}

/// True when `a` comes before `b`: numbers compare by value, the rest by bytes; a strict order on all names.
inline bool naturally_less(std::string_view a, std::string_view b) noexcept {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string_view x = take_number(a, i), y = take_number(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
    }
  }
  if ((a.size() - i) != (b.size() - j)) return a.size() - i < b.size() - j;
  return a < b;  // equal but for leading zeros
}

struct NumberedName {
  std::string around;  ///< the name without its last number
  std::uint64_t number = 0;
};

/// Takes a file name (without extension) apart at its last number; nothing when it has none below 10^18.
inline std::optional<NumberedName> last_number(std::string_view stem) {
  std::size_t end = stem.size();
  while (end > 0 && !is_digit(stem[end - 1])) --end;
  std::size_t begin = end;
  while (begin > 0 && is_digit(stem[begin - 1])) --begin;
  if (begin == end || end - begin > 18) return std::nullopt;
  NumberedName name{std::string(stem.substr(0, begin)) + '\0' + std::string(stem.substr(end)), 0};
  for (const char c : stem.substr(begin, end - begin)) name.number = name.number * 10 + static_cast<unsigned>(c - '0');
  return name;
}

/// The number K of a camera name "camK", with "_" or the end behind it; nothing for other names.
inline std::optional<std::uint64_t> camera_number(std::string_view name) noexcept {
  if (name.substr(0, 3) != "cam") return std::nullopt;
  std::size_t end = 3;
  std::uint64_t number = 0;
  for (; end < name.size() && is_digit(name[end]) && end < 12; ++end)
    number = number * 10 + static_cast<unsigned>(name[end] - '0');
  if (end == 3 || (end < name.size() && name[end] != '_')) return std::nullopt;
  return number;
}

}  // namespace rptv
