// SPDX-License-Identifier: MIT
// Image files from outside: whatever the bytes, headers and pixels are read or refused with an Error.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "replay/image_file.hpp"

namespace {

constexpr std::size_t kMostBytes = std::size_t{16} << 20;  // of one decoded page
constexpr std::size_t kMostPages = 8;

/// A file in memory that the library opens by name.
const std::string& memory_file(const std::uint8_t* data, std::size_t size) {
  static const int file = memfd_create("fuzz_image", 0);
  static const std::string name = "/proc/self/fd/" + std::to_string(file);
  if (file < 0 || ftruncate(file, 0) != 0 || pwrite(file, data, size, 0) != static_cast<ssize_t>(size)) std::abort();
  return name;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string& file = memory_file(data, size);
  try {
    const auto reader = rptv::open_image(file);
    for (std::size_t page = 0; page < reader->pages() && page < kMostPages; ++page) {
      const rptv::ImageHeader& header = reader->header(page);
      const std::uint32_t depth = header.shape.bytes_per_pixel * 8;
      if ((depth != 8 && depth != 16) || header.significant_bits < 1 || header.significant_bits > depth) std::abort();
      if (header.shape.bytes() > kMostBytes) continue;
      std::vector<std::byte> pixels(header.shape.bytes());  // exact size: AddressSanitizer sees one byte too many
      reader->decode(page, pixels);
    }
  } catch (const rptv::Error& error) {
    if (std::string(error.what()).find(file) != 0) std::abort();  // every message begins with the file's name
  }
  return 0;
}
