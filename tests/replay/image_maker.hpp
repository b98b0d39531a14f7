// SPDX-License-Identifier: MIT
// Images, TIFF variants and folders that the replay tests make for themselves.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/image.hpp"

namespace rptv::testing {

/// Pixels with an owner.
struct Picture {
  ImageShape shape;
  std::vector<std::byte> pixels;
  ImageView view() const { return {pixels.data(), shape}; }
  bool operator==(const Picture&) const = default;
};

/// Deterministic noise over a gradient: no row, column, byte or picture equals another.
Picture make_picture(std::uint32_t width, std::uint32_t height, std::uint32_t bytes_per_pixel, std::uint32_t seed);

struct TiffForm {
  bool big_tiff = false;
  bool big_endian = false;
  std::uint32_t rows_per_strip = 7;  ///< not a divisor of the heights used, so that the last strip is short
  std::uint32_t tile = 0;            ///< side of square tiles; 0: strips
  std::uint16_t compression = 1;     ///< COMPRESSION_NONE
  std::uint16_t photometric = 1;     ///< PHOTOMETRIC_MINISBLACK
  std::uint16_t orientation = 1;     ///< ORIENTATION_TOPLEFT
  std::uint16_t samples = 1;
  std::uint16_t sample_format = 1;  ///< SAMPLEFORMAT_UINT
  bool with_thumbnails = false;     ///< a reduced copy after every page
};
void write_tiff(const std::filesystem::path& file, const std::vector<Picture>& pages, const TiffForm& form = {});

/// A PNG of a kind that replay must refuse. `colour_type` and `bits` as in libpng.
void write_odd_png(const std::filesystem::path& file, int colour_type, int bits);
/// An Adam7-interlaced grey PNG.
void write_interlaced_png(const std::filesystem::path& file, const Picture& picture);

/// Opens and decodes one page.
Picture read_picture(const std::filesystem::path& file, std::size_t page = 0);

/// An empty folder of this test, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

void write_text(const std::filesystem::path& file, const std::string& text);
void cut_short(const std::filesystem::path& file, double fraction);

/// Code and text of the Error that `action` throws; {ok, "no error"} when it does not.
template <class Action>
std::pair<ExitCode, std::string> error_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {ExitCode::ok, "no error"};
}

}  // namespace rptv::testing
