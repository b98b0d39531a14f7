// SPDX-License-Identifier: MIT
// Errors about image files, and the C callbacks' message buffer; internal to replay/.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace rptv {

/// `file: reason; step`
inline Error image_error(const std::filesystem::path& file, std::string_view reason, std::string_view step,
                         ExitCode code = ExitCode::bad_data) {
  return {code, file.string() + ": " + std::string(reason) + "; " + std::string(step)};
}

inline constexpr std::string_view kCopyAgain = "copy the file again, or leave it out with replay.pattern";
inline constexpr std::string_view kConvert = "convert it to 8- or 16-bit grey, or leave it out with replay.pattern";

/// The first message that a C library gave, without allocation.
struct LibraryMessage {
  std::array<char, 200> text{};

  bool empty() const noexcept { return text[0] == '\0'; }
  void clear() noexcept { text[0] = '\0'; }
  std::string_view view() const noexcept { return text.data(); }
};

/// `errno` of a failed open or write as an Error.
Error system_error(const std::filesystem::path& file, int code, std::string_view doing);

class ImageReader;
std::unique_ptr<ImageReader> open_png(const std::filesystem::path& file);
std::unique_ptr<ImageReader> open_tiff(const std::filesystem::path& file);

}  // namespace rptv
