// SPDX-License-Identifier: MIT
// Words and numbers, with the line that they are in.
#include "calibration/number_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace rptv {

namespace {
bool is_space(char c) noexcept { return c == ' ' || (c >= '\t' && c <= '\r'); }
}  // namespace

void NumberText::skip_space() {
  for (; position_ < text_.size() && is_space(text_[position_]); ++position_) line_ += text_[position_] == '\n';
}

bool NumberText::at_end() {
  skip_space();
  return position_ == text_.size();
}

void NumberText::refuse(std::string_view what, std::string_view problem) const {
  throw Error(ExitCode::bad_data, fmt::format("{}:{}: {} {} {}", origin_, line_, what, in_quotes(word_), problem));
}

std::string_view NumberText::word(std::string_view what) {
  if (at_end())
    throw Error(ExitCode::bad_data,
                fmt::format("{}:{}: ends before {}; the file is cut off, or of another kind", origin_, line_, what));
  const std::size_t begin = position_;
  while (position_ < text_.size() && !is_space(text_[position_])) ++position_;
  return word_ = text_.substr(begin, position_ - begin);
}

double NumberText::number(std::string_view what) {
  std::string_view text = word(what);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || stop != text.data() + text.size() || !std::isfinite(value))
    refuse(what, "is no finite number; mend it");
  return value;
}

int NumberText::integer(std::string_view what, int low, int high) {
  const double value = number(what);
  if (!(value >= low && value <= high) || value != std::floor(value))
    refuse(what, fmt::format("is no whole number from {} to {}; mend it", low, high));
  return static_cast<int>(value);
}

}  // namespace rptv
