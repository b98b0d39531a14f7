// SPDX-License-Identifier: MIT
// Any bytes as tables of points, tracks and correspondences: rows or a refusal in one line, the same from memory and
// from a file.
#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "calibration/light_field/correspondences.hpp"
#include "core/error.hpp"
#include "core/tables.hpp"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

/// How a table ended: rows read, and the refusal without the file's name.
struct Outcome {
  std::size_t rows = 0;
  std::string refusal;
  bool operator==(const Outcome&) const = default;
};

template <class Open, class Row>
Outcome read_all(const std::string& name, Open open, Row row) {
  Outcome outcome;
  try {
    auto table = open();
    while (table.next(row)) ++outcome.rows;
  } catch (const rptv::Error& error) {
    require(std::strchr(error.what(), '\n') == nullptr && std::strncmp(error.what(), name.c_str(), name.size()) == 0);
    outcome.refusal = error.what() + name.size();
  }
  return outcome;
}

template <class Table, class Row>
void compare(std::string_view text, const std::string& file) {
  const Outcome memory = read_all(
      "t.csv", [&] { return Table::from_text(text, "t.csv"); }, Row{});
  require(memory == read_all(
                        file, [&] { return Table(file); }, Row{}));
}

/// Correspondences are read whole: rows, or a refusal that names the file.
Outcome correspondences(const std::string& name, auto read) {
  Outcome outcome;
  try {
    outcome.rows = read().size();
  } catch (const rptv::Error& error) {
    require(std::strchr(error.what(), '\n') == nullptr && std::strncmp(error.what(), name.c_str(), name.size()) == 0);
    outcome.refusal = error.what() + name.size();
  }
  return outcome;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int descriptor = memfd_create("table", MFD_CLOEXEC);
  require(descriptor >= 0 && write(descriptor, data, size) == static_cast<ssize_t>(size));
  const std::string file = "/proc/self/fd/" + std::to_string(descriptor);
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  compare<rptv::PointsReader, rptv::PointFrame>(text, file);
  compare<rptv::TracksReader, rptv::TrackRow>(text, file);
  require(correspondences("t.csv", [&] { return rptv::parse_correspondences(text, "t.csv"); }) ==
          correspondences(file, [&] { return rptv::read_correspondences(file); }));
  close(descriptor);
  return 0;
}
