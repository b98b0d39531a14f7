// SPDX-License-Identifier: MIT
// Grey TIFF and BigTIFF through libtiff: strips or tiles, many pages, either byte order, every compression it knows.
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <vector>

#include "replay/image_error.hpp"
#include "replay/image_file.hpp"

namespace rptv {
namespace {

constexpr tmsize_t kMaxAllocationBytes = tmsize_t{1}
                                         << 30;  // libtiff refuses more at once: a damaged header asks for it

int keep_first(TIFF*, void* user, const char*, const char* format, va_list arguments) {
  auto* message = static_cast<LibraryMessage*>(user);
  if (message->empty()) std::vsnprintf(message->text.data(), message->text.size(), format, arguments);
  return 1;
}
int keep_silent(TIFF*, void*, const char*, const char*, va_list) { return 1; }  // unknown private tags and the like

struct TiffCloser {
  void operator()(TIFF* tiff) const noexcept { TIFFClose(tiff); }
};

/// Mode m: no memory map, because a mapped file that shrinks while it plays would end the process by SIGBUS.
TIFF* open_quietly(const std::filesystem::path& file, LibraryMessage& message) {
  TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
  if (options == nullptr) throw std::bad_alloc();
  TIFFOpenOptionsSetMaxSingleMemAlloc(options, kMaxAllocationBytes);
  TIFFOpenOptionsSetErrorHandlerExtR(options, keep_first, &message);
  TIFFOpenOptionsSetWarningHandlerExtR(options, keep_silent, nullptr);
  TIFF* tiff = TIFFOpenExt(file.c_str(), "rm", options);
  TIFFOpenOptionsFree(options);
  return tiff;
}

template <class T>
T tag(TIFF* tiff, std::uint32_t name, T otherwise) noexcept {
  T value = otherwise;
  return TIFFGetFieldDefaulted(tiff, name, &value) == 1 ? value : otherwise;
}

struct Page {
  std::uint64_t offset = 0;  ///< of its directory: random access without walking the chain
  ImageHeader header;
  bool inverted = false;  ///< white is zero

  bool operator==(const Page& other) const noexcept {
    return header.shape == other.header.shape && inverted == other.inverted;
  }
};

class TiffReader final : public ImageReader {
 public:
  explicit TiffReader(const std::filesystem::path& path) : path_(path), tiff_(open_quietly(path, message_)) {
    if (tiff_ == nullptr) throw damaged();
    do {
      if ((tag<std::uint32_t>(tiff_.get(), TIFFTAG_SUBFILETYPE, 0) & FILETYPE_REDUCEDIMAGE) != 0) continue;
      pages_.push_back(current_page());
      check_complete();
    } while (TIFFReadDirectory(tiff_.get()) == 1);
    if (pages_.empty() || !message_.empty()) throw damaged();
  }
  std::size_t pages() const noexcept override { return pages_.size(); }
  const ImageHeader& header(std::size_t page) const noexcept override { return pages_[page].header; }

  void decode(std::size_t page, std::span<std::byte> pixels) override {
    message_.clear();
    const Page& expected = pages_[page];
    if (TIFFCurrentDirOffset(tiff_.get()) != expected.offset && TIFFSetSubDirectory(tiff_.get(), expected.offset) != 1)
      throw damaged();
    if (!(current_page() == expected) || pixels.size() != expected.header.shape.bytes())
      throw image_error(path_, "has changed its shape since it was opened", kCopyAgain);
    const bool done = TIFFIsTiled(tiff_.get()) != 0 ? read_tiles(expected.header.shape, pixels)
                                                    : read_strips(expected.header.shape, pixels);
    if (!done) throw damaged();
    if (expected.inverted)
      for (std::byte& value : pixels) value = ~value;  // 255 − v, and 65535 − v byte by byte
  }

 private:
  Page current_page() const {
    TIFF* tiff = tiff_.get();
    const auto width = tag<std::uint32_t>(tiff, TIFFTAG_IMAGEWIDTH, 0);
    const auto height = tag<std::uint32_t>(tiff, TIFFTAG_IMAGELENGTH, 0);
    if (width == 0 || height == 0 || width > kMaxImageSidePx || height > kMaxImageSidePx)
      throw refused("has a size of " + std::to_string(width) + " x " + std::to_string(height) + " pixels", kCopyAgain);
    const auto samples = tag<std::uint16_t>(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    if (samples != 1) throw refused("has " + std::to_string(samples) + " channels, not one", kConvert);
    const auto bits = tag<std::uint16_t>(tiff, TIFFTAG_BITSPERSAMPLE, 1);
    if (bits != 8 && bits != 16)
      throw refused("has " + std::to_string(bits) + " bits per pixel, not 8 or 16", kConvert);
    const auto format = tag<std::uint16_t>(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    if (format != SAMPLEFORMAT_UINT && format != SAMPLEFORMAT_VOID)
      throw refused("has signed or floating-point pixels", kConvert);
    const auto photometric = tag<std::uint16_t>(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    if (photometric != PHOTOMETRIC_MINISBLACK && photometric != PHOTOMETRIC_MINISWHITE)
      throw refused("has colour or a palette, not grey values", kConvert);
    if (tag<std::uint16_t>(tiff, TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT) != ORIENTATION_TOPLEFT)
      throw refused("is stored turned or mirrored (TIFF Orientation)", "save it with the first row on top");
    return {TIFFCurrentDirOffset(tiff), {{width, height, bits / 8U}, bits}, photometric == PHOTOMETRIC_MINISWHITE};
  }

  /// Every strip or tile lies inside the file.
  void check_complete() const {
    TIFF* tiff = tiff_.get();
    const std::uint64_t size = TIFFGetSizeProc(tiff)(TIFFClientdata(tiff));
    const std::uint32_t count = TIFFIsTiled(tiff) != 0 ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint64_t offset = TIFFGetStrileOffset(tiff, i);
      const std::uint64_t bytes = TIFFGetStrileByteCount(tiff, i);
      if (bytes == 0 || offset > size || bytes > size - offset)
        throw refused("TIFF is truncated after " + std::to_string(size) + " bytes", kCopyAgain);
    }
  }

  bool read_strips(const ImageShape& shape, std::span<std::byte> pixels) noexcept {
    const auto rows = std::min(tag<std::uint32_t>(tiff_.get(), TIFFTAG_ROWSPERSTRIP, shape.height_px), shape.height_px);
    if (rows == 0) return false;
    std::uint32_t strip = 0;
    for (std::uint32_t row = 0; row < shape.height_px; row += rows, ++strip) {
      const auto bytes = static_cast<tmsize_t>(std::min(rows, shape.height_px - row) * shape.row_bytes());
      if (TIFFReadEncodedStrip(tiff_.get(), strip, pixels.data() + row * shape.row_bytes(), bytes) != bytes)
        return false;
    }
    return true;
  }

  bool read_tiles(const ImageShape& shape, std::span<std::byte> pixels) {
    const auto width = tag<std::uint32_t>(tiff_.get(), TIFFTAG_TILEWIDTH, 0);
    const auto height = tag<std::uint32_t>(tiff_.get(), TIFFTAG_TILELENGTH, 0);
    const tmsize_t bytes = TIFFTileSize(tiff_.get());
    const std::size_t tile_row = std::size_t{width} * shape.bytes_per_pixel;
    if (bytes <= 0 || bytes > kMaxAllocationBytes || tile_row * height != static_cast<std::size_t>(bytes)) return false;
    tile_.resize(static_cast<std::size_t>(bytes));
    for (std::uint32_t y = 0; y < shape.height_px; y += height)
      for (std::uint32_t x = 0; x < shape.width_px; x += width) {
        const std::uint32_t tile = TIFFComputeTile(tiff_.get(), x, y, 0, 0);
        if (TIFFReadEncodedTile(tiff_.get(), tile, tile_.data(), bytes) != bytes) return false;
        const std::size_t inside = std::min(width, shape.width_px - x) * std::size_t{shape.bytes_per_pixel};
        for (std::uint32_t row = 0; row < std::min(height, shape.height_px - y); ++row)
          std::memcpy(pixels.data() + (y + row) * shape.row_bytes() + x * std::size_t{shape.bytes_per_pixel},
                      tile_.data() + row * tile_row, inside);
      }
    return true;
  }

  Error refused(const std::string& reason, std::string_view step) const {
    const std::string page = pages_.size() > 1 ? "page " + std::to_string(pages_.size()) + " " : "";
    return image_error(path_, page + reason, step);
  }
  Error damaged() const {
    const std::string why = message_.empty() ? "" : " (" + std::string(message_.view()) + ")";
    return image_error(path_, "TIFF is truncated or damaged" + why, kCopyAgain);
  }

  std::filesystem::path path_;
  LibraryMessage message_;  // before tiff_, which writes to it
  std::unique_ptr<TIFF, TiffCloser> tiff_;
  std::vector<Page> pages_;
  std::vector<std::byte> tile_;
};

}  // namespace

std::unique_ptr<ImageReader> open_tiff(const std::filesystem::path& file) { return std::make_unique<TiffReader>(file); }

}  // namespace rptv
