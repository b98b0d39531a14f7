// SPDX-License-Identifier: MIT
// Tells PNG from TIFF by the first bytes.
#include "replay/image_file.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "replay/image_error.hpp"

namespace rptv {

Error system_error(const std::filesystem::path& file, int code, std::string_view doing) {
  const std::string reason = "cannot be " + std::string(doing) + " (" + std::strerror(code) + ")";
  if (code == ENOENT) return image_error(file, reason, "check the path", ExitCode::no_input);
  if (code == EACCES || code == EPERM || code == EROFS)
    return image_error(file, reason, "check its owner and mode", ExitCode::permission);
  return image_error(file, reason, "check the disk and the path", ExitCode::io);
}

namespace {

using Magic = std::array<unsigned char, 8>;

Magic first_bytes(const std::filesystem::path& file) {
  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> handle(std::fopen(file.c_str(), "rbe"), std::fclose);
  if (handle == nullptr) throw system_error(file, errno, "opened");
  Magic bytes{};
  const std::size_t got = std::fread(bytes.data(), 1, bytes.size(), handle.get());
  if (std::ferror(handle.get()) != 0) throw system_error(file, errno, "read");
  if (got == 0) throw image_error(file, "the file is empty", kCopyAgain);
  return bytes;
}

bool starts_with(const Magic& bytes, std::string_view magic) noexcept {
  return std::memcmp(bytes.data(), magic.data(), magic.size()) == 0;
}

}  // namespace

std::unique_ptr<ImageReader> open_image(const std::filesystem::path& file) {
  const Magic magic = first_bytes(file);
  if (starts_with(magic, "\x89PNG\r\n\x1a\n")) return open_png(file);
  for (const std::string_view tiff : {std::string_view("II\x2a\0", 4), std::string_view("MM\0\x2a", 4),
                                      std::string_view("II\x2b\0", 4), std::string_view("MM\0\x2b", 4)})
    if (starts_with(magic, tiff)) return open_tiff(file);
  throw image_error(file, "is neither PNG nor TIFF", kConvert);
}

}  // namespace rptv
