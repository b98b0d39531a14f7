// SPDX-License-Identifier: MIT
// Writes tables: buffered, locale free, and without an allocation per row.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/descriptor.hpp"

namespace rptv {

/// Writes a header and rows; doubles as the shortest text that reads back bit for bit. The calls that write allocate
/// nothing and never throw: the first failure (disk full) is kept, the rest of the rows are dropped, and check() or
/// close() throws it as Error(io) with the path. One thread at a time.
class CsvWriter {
 public:
  /// "-" is standard output. Throws Error(permission or io) when the file cannot be created.
  CsvWriter(const std::filesystem::path& file, std::string_view header);
  ~CsvWriter();  ///< writes what is left; call close() to learn of failures
  CsvWriter(CsvWriter&&) noexcept = default;
  CsvWriter& operator=(CsvWriter&&) = delete;

  CsvWriter& number(double value) noexcept;
  CsvWriter& integer(std::int64_t value) noexcept;
  CsvWriter& index(std::uint64_t value) noexcept;
  CsvWriter& text(std::string_view value) noexcept;  ///< quoted where it must be
  void end_row() noexcept;

  bool ok() const noexcept { return error_ == 0; }
  bool flush() noexcept;  ///< hands everything to the operating system; false after a failure
  void check() const;     ///< throws when something has failed
  void close();           ///< flush, close, check. Idempotent

 private:
  template <class Number>
  CsvWriter& put_number(Number value) noexcept;
  void separate() noexcept;
  void put(std::string_view bytes) noexcept;

  std::string origin_;
  Descriptor file_;
  int error_ = 0;  // errno of the first failure
  bool row_begun_ = false;
  std::vector<char> buffer_;
  std::size_t used_ = 0;
};

}  // namespace rptv
