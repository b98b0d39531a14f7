// SPDX-License-Identifier: MIT
// A walk over TOML text that knows strings and comments and nothing else.
#include "core/toml_precheck.hpp"

#include "core/utf8.hpp"

namespace rptv {
namespace {

constexpr std::size_t kMostKeyParts = 32;

class Walk {
 public:
  explicit Walk(std::string_view text) : text_(text) {}

  std::optional<TomlObjection> run() {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;
    while (!objection_ && at_ < text_.size()) step();
    return objection_;
  }

 private:
  char now() const { return at_ < text_.size() ? text_[at_] : '\n'; }
  bool beyond_ascii() const { return static_cast<unsigned char>(now()) >= 0x80; }

  void object(std::string text) {
    if (!objection_) objection_ = TomlObjection{line_, column_, std::move(text)};
    at_ = text_.size();
  }

  /// Over one character.
  void advance() {
    const std::size_t bytes = utf8_length(text_.substr(at_));
    if (bytes == 0) return object("the text is not UTF-8; save the file as UTF-8");
    ++column_;
    if (now() == '\n') {
      ++line_;
      column_ = 1;
    }
    at_ += bytes;
  }

  void step() {
    const char c = now();
    if (c == '#') {
      while (now() != '\n') advance();
    } else if (c == '"' || c == '\'') {
      skip_string(c);
      key_char_ = true;
    } else if (beyond_ascii()) {
      object("a character beyond ASCII outside of quotes; put the text in quotes");
    } else {
      count_key_parts(c);
      advance();
    }
  }

  void count_key_parts(char c) {
    if (c == '.' && key_char_ && ++dots_ >= kMostKeyParts) object("a key of more than 32 parts; shorten it");
    if (std::string_view("\n,=[]{}").find(c) != std::string_view::npos || (c == '.' && !key_char_)) dots_ = 0;
    if (c != ' ' && c != '\t') key_char_ = c != '.';
  }

  /// From the opening quotes to behind the closing ones, or to where the parser will complain.
  void skip_string(char quote) {
    const std::string three(3, quote);
    const bool many_lines = text_.substr(at_).starts_with(three);
    for (int i = many_lines ? 3 : 1; i > 0; --i) advance();
    while (at_ < text_.size() && (many_lines || now() != '\n')) {
      if (now() == quote && (!many_lines || text_.substr(at_).starts_with(three))) break;
      if (now() == '\\' && quote == '"') {
        advance();
        if (many_lines && (now() == ' ' || now() == '\t' || now() == '\r' || now() == '\n')) {
          skip_line_end();
          continue;
        }
      }
      if (at_ < text_.size() && (many_lines || now() != '\n')) advance();
    }
    for (int i = many_lines ? 5 : 1; i > 0 && at_ < text_.size() && now() == quote; --i) advance();
  }

  void skip_line_end() {
    while (at_ < text_.size() && (now() == ' ' || now() == '\t' || now() == '\r' || now() == '\n')) advance();
    if (beyond_ascii()) object("a character beyond ASCII behind a line-ending backslash; write the string on one line");
  }

  std::string_view text_;
  std::size_t at_ = 0, line_ = 1, column_ = 1;
  std::size_t dots_ = 0;   // of the key so far
  bool key_char_ = false;  // the last character that was no blank may belong to a key
  std::optional<TomlObjection> objection_;
};

}  // namespace

std::optional<TomlObjection> precheck_toml(std::string_view text) { return Walk(text).run(); }

}  // namespace rptv
