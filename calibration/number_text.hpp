// SPDX-License-Identifier: MIT
// Files that are words and numbers between white space, in a fixed order.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "calibration/space.hpp"

namespace rptv {

/// Takes one word or number after the other from a text. Errors (bad_data) name `origin:line`, the text found and what
/// was expected. Set-up only; `text` must outlive it.
class NumberText {
 public:
  NumberText(std::string_view text, std::string origin) : text_(text), origin_(std::move(origin)) {}

  /// `what` says in messages what the word or number means: "the camera's x (mm)".
  std::string_view word(std::string_view what);
  double number(std::string_view what);  ///< finite
  Point3 point(std::string_view what) { return {number(what), number(what), number(what)}; }
  /// Whole number from `low` to `high`.
  int integer(std::string_view what, int low, int high);
  /// Whether nothing but white space is left.
  bool at_end();

  /// Throws for the word taken last: "origin:line: what '<word>' problem".
  [[noreturn]] void refuse(std::string_view what, std::string_view problem) const;

 private:
  void skip_space();

  std::string_view text_, word_;
  std::string origin_;
  std::size_t position_ = 0, line_ = 1;
};

}  // namespace rptv
