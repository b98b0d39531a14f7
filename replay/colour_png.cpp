// SPDX-License-Identifier: MIT
// Colour PNGs through libpng's simple interface.
#include "replay/colour_png.hpp"

#include <png.h>

#include <cerrno>
#include <string>

#include "core/error.hpp"

namespace rptv {

void write_colour_png(const std::filesystem::path& file, const ColourImage& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width), png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  errno = 0;
  if (png_image_write_to_file(&png, file.c_str(), 0, image.pixels.data(), 0, nullptr) != 0) return;
  throw Error(errno == EACCES ? ExitCode::permission : ExitCode::io,
              file.string() + ": cannot be written (" + png.message + "); check folder, permissions and space");
}

}  // namespace rptv
