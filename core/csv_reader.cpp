// SPDX-License-Identifier: MIT
// Reading of tables: lines from a growing window over the file, cells as views into it.
#include "core/csv_reader.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "core/error.hpp"
#include "core/quote.hpp"

namespace rptv {
namespace {

constexpr std::size_t kFirstBufferBytes = 64 * 1024;

int open_to_read(const std::filesystem::path& file) {
  if (file == "-") return STDIN_FILENO;
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor >= 0) return descriptor;
  const int reason = errno;
  if (reason == EACCES) throw Error(ExitCode::permission, file.string() + ": may not be read; check its permissions");
  throw Error(ExitCode::no_input,
              file.string() + ": " + std::generic_category().message(reason) + "; check the path of the table");
}

std::string_view trim(std::string_view text) noexcept {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

/// std::from_chars, plus a leading '+', over the whole of `text`.
template <class Number>
std::errc parse(std::string_view text, Number& value) noexcept {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return error;
  return stop == text.data() + text.size() ? std::errc() : std::errc::invalid_argument;
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& file, std::vector<CsvColumn> columns)
    : CsvReader(file == "-" ? std::string("stdin") : file.string(), open_to_read(file), {}, std::move(columns)) {}

CsvReader CsvReader::from_text(std::string_view text, std::string origin, std::vector<CsvColumn> columns) {
  return CsvReader(std::move(origin), -1, text, std::move(columns));
}

CsvReader::CsvReader(std::string origin, int file, std::string_view text, std::vector<CsvColumn> columns)
    : origin_(std::move(origin)), file_(file), columns_(std::move(columns)), buffer_(text.begin(), text.end()) {
  end_ = buffer_.size();
  if (file_.open()) buffer_.resize(kFirstBufferBytes);
  read_header();
}

/// Fills the window behind end_, making room first; false at the end of the file.
bool CsvReader::read_more() {
  if (!file_.open()) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(buffer_.size() * 2);
  ssize_t got;
  do {
    got = ::read(file_.get(), buffer_.data() + end_, buffer_.size() - end_);
  } while (got < 0 && errno == EINTR);
  if (got < 0) {
    const int reason = errno;
    throw Error(
        reason == EISDIR ? ExitCode::no_input : ExitCode::io,
        origin_ + ": cannot be read: " + std::generic_category().message(reason) + "; give the path of a table");
  }
  end_ += static_cast<std::size_t>(got);
  return got > 0;
}

/// The next line without its end; false when there is none.
bool CsvReader::read_line(std::string_view& line) {
  std::size_t searched = 0;
  bool more = true;
  while (true) {
    const char* start = buffer_.data() + begin_;
    const std::size_t length = end_ - begin_;
    const auto* stop =
        length > searched ? static_cast<const char*>(std::memchr(start + searched, '\n', length - searched)) : nullptr;
    const std::size_t line_bytes = stop != nullptr ? static_cast<std::size_t>(stop - start) : length;
    if (line_bytes > kLongestLineBytes) {
      ++line_;
      refuse("the line is longer than 1 MiB; is this a CSV table?");
    }
    if (stop != nullptr || !more) {
      if (stop == nullptr && length == 0) return false;
      line = {start, line_bytes};
      if (line.ends_with('\r')) line.remove_suffix(1);
      begin_ += stop != nullptr ? line_bytes + 1 : line_bytes;
      ++line_;
      return true;
    }
    searched = length;
    more = read_more();
  }
}

/// Cells of `line` into cells_, unescaping quoted ones in place in the buffer.
void CsvReader::split(std::string_view line) {
  cells_.clear();
  char* const first = buffer_.data() + (line.data() - buffer_.data());
  char* const last = first + line.size();
  char* at = first;
  while (true) {
    while (at < last && (*at == ' ' || *at == '\t')) ++at;
    if (at < last && *at == '"') {
      char* const cell = ++at;
      char* out = cell;
      while (at < last && !(*at == '"' && (at + 1 == last || at[1] != '"'))) {
        if (*at == '"') ++at;
        *out++ = *at++;
      }
      if (at == last) refuse("a quoted cell is not closed; close the quote on the same line");
      ++at;
      cells_.emplace_back(cell, static_cast<std::size_t>(out - cell));
      while (at < last && (*at == ' ' || *at == '\t')) ++at;
      if (at < last && *at != ',') refuse("text follows a quoted cell; put a comma between cells");
    } else {
      char* const comma = std::find(at, last, ',');
      cells_.push_back(trim({at, static_cast<std::size_t>(comma - at)}));
      at = comma;
    }
    if (at == last) break;
    ++at;
    if (width_ != 0 && cells_.size() > width_) break;  // the caller refuses it
  }
}

void CsvReader::read_header() {
  std::string expected;
  for (const auto& column : columns_)
    if (column.required) expected += (expected.empty() ? "" : ",") + column.name;
  std::string_view line;
  do {
    if (!read_line(line))
      throw Error(ExitCode::bad_data, origin_ + ": is empty; the first line must name the columns " + expected);
    if (line_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  } while (trim(line).empty());
  const std::string found = in_quotes(line, 200);
  split(line);
  for (const auto& column : columns_) {
    position_.push_back(find(column));
    if (position_.back() == kAbsent && column.required)
      refuse("no column '" + column.name + "'; the header is " + found + ", columns are separated by commas");
  }
  width_ = cells_.size();
  cells_.reserve(width_ + 1);
}

std::size_t CsvReader::find(const CsvColumn& column) const {
  const auto position_of = [&](const std::string& name) {
    const auto hit = std::find(cells_.begin(), cells_.end(), name);
    if (hit == cells_.end()) return kAbsent;
    if (std::find(hit + 1, cells_.end(), name) != cells_.end())
      refuse("two columns are named " + in_quotes(name) + "; rename one");
    return static_cast<std::size_t>(hit - cells_.begin());
  };
  std::size_t position = position_of(column.name);
  for (const auto& alias : column.aliases)
    if (position == kAbsent) position = position_of(alias);
  return position;
}

bool CsvReader::next() {
  std::string_view line;
  do {
    if (!read_line(line)) return false;
  } while (trim(line).empty());
  split(line);
  if (cells_.size() != width_)
    refuse("the row has " + (cells_.size() > width_ ? "more cells" : std::to_string(cells_.size()) + " cells") +
           " where the header has " + std::to_string(width_) + "; is the file cut off?");
  return true;
}

double CsvReader::number(std::size_t column) const {
  double value = 0;
  const std::errc error = parse(text(column), value);
  if (error == std::errc::result_out_of_range) refuse_cell(column, "beyond the range of a double");
  if (error != std::errc()) refuse_cell(column, "not a number");
  if (!std::isfinite(value)) refuse_cell(column, "not finite");
  return value;
}

double CsvReader::number_or_nan(std::size_t column) const {
  double value = std::numeric_limits<double>::quiet_NaN();
  if (!text(column).empty() && parse(text(column), value) != std::errc()) refuse_cell(column, "not a number");
  return value;
}

std::int64_t CsvReader::integer(std::size_t column) const {
  std::int64_t value = 0;
  if (parse(text(column), value) == std::errc()) return value;
  double real = 0;
  constexpr double kExact = 9007199254740992.0;  // 2^53: integers up to here are doubles
  if (parse(text(column), real) != std::errc() || real != std::floor(real) || std::fabs(real) > kExact)
    refuse_cell(column, "not an integer");
  return static_cast<std::int64_t>(real);
}

std::uint64_t CsvReader::index(std::size_t column) const {
  const std::int64_t value = integer(column);
  if (value < 0) refuse_cell(column, "negative");
  return static_cast<std::uint64_t>(value);
}

void CsvReader::refuse(const std::string& text) const {
  throw Error(ExitCode::bad_data, origin_ + ":" + std::to_string(line_) + ": " + text);
}

void CsvReader::refuse_cell(std::size_t column, std::string_view what) const {
  refuse("column '" + columns_[column].name + "' is " + in_quotes(text(column)) + ", " + std::string(what) +
         "; mend the cell or remove the row");
}

}  // namespace rptv
