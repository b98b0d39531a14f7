// SPDX-License-Identifier: MIT
// Reads tables row by row, with file, line and column in every error.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/descriptor.hpp"

namespace rptv {

/// A column that a reader looks for: by its name, else by the first alias that the header has.
struct CsvColumn {
  std::string name;
  std::vector<std::string> aliases = {};
  bool required = true;
};

/// Reads one header line and then row by row; memory does not grow with the file and next() allocates nothing once the
/// longest line has been seen. Accepts CRLF, blank lines, a byte order mark, blanks around cells and quoted cells
/// (without line breaks inside). All errors are Error(bad_data, "points.csv:17: …; next step"), except for files that
/// cannot be opened (no_input, permission) or read (io). One thread at a time; set-up and batch commands only.
class CsvReader {
 public:
  static constexpr std::size_t kLongestLineBytes = std::size_t{1} << 20;

  /// "-" is standard input. Throws when a required column is missing or the file is empty.
  CsvReader(const std::filesystem::path& file, std::vector<CsvColumn> columns);
  /// The same over text in memory; `origin` stands for the file's name in messages.
  static CsvReader from_text(std::string_view text, std::string origin, std::vector<CsvColumn> columns);

  /// Goes to the next row; false at the end. Throws when its number of cells is not the header's.
  bool next();

  // Cells of the current row; `column` is the position in the list given to the constructor, and must be there (has()).
  bool has(std::size_t column) const noexcept { return position_[column] != kAbsent; }
  double number(std::size_t column) const;         ///< finite; throws on NaN and infinity
  double number_or_nan(std::size_t column) const;  ///< NaN, infinity and (as NaN) an empty cell are values here
  std::int64_t integer(std::size_t column) const;  ///< also "17.0", as dataframes write integers
  std::uint64_t index(std::size_t column) const;   ///< an integer that is not negative
  std::string_view text(std::size_t column) const noexcept { return cells_[position_[column]]; }

  std::size_t line() const noexcept { return line_; }  ///< of the current row, from 1
  /// Throws Error(bad_data, "file:line: text") about the current row, for checks that the caller makes.
  [[noreturn]] void refuse(const std::string& text) const;

 private:
  static constexpr std::size_t kAbsent = static_cast<std::size_t>(-1);
  CsvReader(std::string origin, int file, std::string_view text, std::vector<CsvColumn> columns);
  bool read_line(std::string_view& line);
  bool read_more();
  void split(std::string_view line);
  void read_header();
  std::size_t find(const CsvColumn& column) const;
  [[noreturn]] void refuse_cell(std::size_t column, std::string_view what) const;

  std::string origin_;
  Descriptor file_;  // none: text in memory
  std::vector<CsvColumn> columns_;
  std::vector<std::size_t> position_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;
  std::size_t line_ = 0;
  std::vector<std::string_view> cells_;
  std::size_t width_ = 0;  // cells per row; 0 before the header
};

}  // namespace rptv
