// SPDX-License-Identifier: MIT
// Writing of tables: cells into a fixed buffer, the buffer to the file when it is full.
#include "core/csv_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/error.hpp"

namespace rptv {
namespace {

constexpr std::size_t kBufferBytes = 64 * 1024;

int open_to_write(const std::filesystem::path& file) {
  if (file == "-") return STDOUT_FILENO;
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor >= 0) return descriptor;
  const int reason = errno;
  if (reason == EACCES || reason == EPERM || reason == EROFS)
    throw Error(ExitCode::permission, file.string() + ": may not be written; choose another path or mend permissions");
  const std::string next = reason == ENOENT ? "create its folder first" : "choose another path";
  throw Error(ExitCode::io, file.string() + ": " + std::generic_category().message(reason) + "; " + next);
}

}  // namespace

CsvWriter::CsvWriter(const std::filesystem::path& file, std::string_view header)
    : origin_(file == "-" ? std::string("stdout") : file.string()), file_(open_to_write(file)), buffer_(kBufferBytes) {
  put(header);
  put("\n");
}

CsvWriter::~CsvWriter() { flush(); }

void CsvWriter::put(std::string_view bytes) noexcept {
  while (!bytes.empty() && ok()) {
    if (used_ == buffer_.size() && !flush()) return;
    const std::size_t part = std::min(bytes.size(), buffer_.size() - used_);
    std::memcpy(buffer_.data() + used_, bytes.data(), part);
    used_ += part;
    bytes.remove_prefix(part);
  }
}

void CsvWriter::separate() noexcept {
  if (row_begun_) put(",");
  row_begun_ = true;
}

/// Straight into the buffer, where numbers of any kind have room.
template <class Number>
CsvWriter& CsvWriter::put_number(Number value) noexcept {
  constexpr std::size_t kLongest = 32;  // the shortest round-trip text of a double has at most 24 characters
  if (buffer_.size() - used_ < kLongest + 1 && !flush()) return *this;
  char* const begin = buffer_.data() + used_;
  char* at = begin;
  if (row_begun_) *at++ = ',';
  row_begun_ = true;
  at = std::to_chars(at, at + kLongest, value).ptr;
  used_ += static_cast<std::size_t>(at - begin);
  return *this;
}

CsvWriter& CsvWriter::number(double value) noexcept { return put_number(value); }
CsvWriter& CsvWriter::integer(std::int64_t value) noexcept { return put_number(value); }
CsvWriter& CsvWriter::index(std::uint64_t value) noexcept { return put_number(value); }

CsvWriter& CsvWriter::text(std::string_view value) noexcept {
  separate();
  const bool blank_at_end = !value.empty() && (value.front() == ' ' || value.back() == ' ');
  if (value.find_first_of(",\"\r\n\t") == std::string_view::npos && !blank_at_end) {
    put(value);
    return *this;
  }
  put("\"");
  for (const char& c : value) {
    if (c == '"') put("\"");
    put(c == '\r' || c == '\n' ? std::string_view(" ") : std::string_view(&c, 1));  // a row is one line
  }
  put("\"");
  return *this;
}

void CsvWriter::end_row() noexcept {
  put("\n");
  row_begun_ = false;
}

bool CsvWriter::flush() noexcept {
  std::size_t done = 0;
  while (done < used_ && ok() && file_.open()) {
    const ssize_t written = ::write(file_.get(), buffer_.data() + done, used_ - done);
    if (written > 0)
      done += static_cast<std::size_t>(written);
    else if (written == 0 || errno != EINTR)
      error_ = written == 0 ? EIO : errno;
  }
  used_ = 0;
  return ok();
}

void CsvWriter::check() const {
  if (ok()) return;
  const std::string next = error_ == ENOSPC || error_ == EDQUOT ? "free some space and run it again"
                           : error_ == EPIPE                    ? "the reader of the pipe has gone"
                                                                : "choose another path";
  throw Error(ExitCode::io, origin_ + ": cannot be written: " + std::generic_category().message(error_) + "; " + next);
}

void CsvWriter::close() {
  flush();
  if (const int failure = file_.close(); failure != 0 && ok()) error_ = failure;
  check();
}

}  // namespace rptv
