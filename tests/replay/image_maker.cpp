// SPDX-License-Identifier: MIT
// Makes test images with libtiff and libpng directly, so that what replay reads was not written by replay.
#include "tests/replay/image_maker.hpp"

#include <png.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "replay/image_file.hpp"

namespace rptv::testing {

Picture make_picture(std::uint32_t width, std::uint32_t height, std::uint32_t bytes_per_pixel, std::uint32_t seed) {
  Picture picture{{width, height, bytes_per_pixel}, {}};
  picture.pixels.resize(picture.shape.bytes());
  std::uint32_t state = seed * 2654435761U + 12345U;
  for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
    state = state * 1664525U + 1013904223U;
    picture.pixels[i] = static_cast<std::byte>((state >> 24) + i / 16);
  }
  return picture;
}

namespace {

void write_page(TIFF* tiff, const Picture& page, const TiffForm& form, bool thumbnail) {
  const ImageShape& shape = page.shape;
  TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, thumbnail ? FILETYPE_REDUCEDIMAGE : 0);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, shape.width_px);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, shape.height_px);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(shape.bytes_per_pixel * 8));
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, form.samples);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, form.sample_format);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, form.compression);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, form.photometric);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, form.orientation);
  std::vector<std::byte> pixels = page.pixels;
  const auto row_bytes = static_cast<std::size_t>(form.samples) * shape.row_bytes();
  pixels.resize(row_bytes * shape.height_px);
  if (form.tile == 0) {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, form.rows_per_strip);
    for (std::uint32_t row = 0; row < shape.height_px; ++row)
      if (TIFFWriteScanline(tiff, pixels.data() + row * row_bytes, row, 0) != 1) throw std::runtime_error("scanline");
  } else {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, form.tile);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, form.tile);
    std::vector<std::byte> tile(static_cast<std::size_t>(TIFFTileSize(tiff)));
    for (std::uint32_t y = 0; y < shape.height_px; y += form.tile)
      for (std::uint32_t x = 0; x < shape.width_px; x += form.tile) {
        std::fill(tile.begin(), tile.end(), std::byte{0xEE});
        for (std::uint32_t row = 0; row < std::min(form.tile, shape.height_px - y); ++row)
          std::memcpy(tile.data() + row * std::size_t{form.tile} * shape.bytes_per_pixel,
                      pixels.data() + (y + row) * row_bytes + x * std::size_t{shape.bytes_per_pixel},
                      std::min(form.tile, shape.width_px - x) * std::size_t{shape.bytes_per_pixel});
        if (TIFFWriteTile(tiff, tile.data(), x, y, 0, 0) < 0) throw std::runtime_error("tile");
      }
  }
  if (TIFFWriteDirectory(tiff) != 1) throw std::runtime_error("directory");
}

}  // namespace

void write_tiff(const std::filesystem::path& file, const std::vector<Picture>& pages, const TiffForm& form) {
  const std::string mode = std::string("w") + (form.big_tiff ? "8" : "") + (form.big_endian ? "b" : "l");
  TIFF* tiff = TIFFOpen(file.c_str(), mode.c_str());
  if (tiff == nullptr) throw std::runtime_error("cannot write " + file.string());
  for (const Picture& page : pages) {
    write_page(tiff, page, form, false);
    if (form.with_thumbnails) write_page(tiff, make_picture(4, 4, page.shape.bytes_per_pixel, 1), form, true);
  }
  TIFFClose(tiff);
}

namespace {

void write_with_libpng(const std::filesystem::path& file, const Picture& picture, int colour_type, int bits,
                       int interlace) {
  std::FILE* handle = std::fopen(file.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  if (handle == nullptr || setjmp(png_jmpbuf(png)) != 0) std::abort();
  png_init_io(png, handle);
  png_set_IHDR(png, info, picture.shape.width_px, picture.shape.height_px, bits, colour_type, interlace,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[2] = {{0, 0, 0}, {255, 0, 0}};
  if (colour_type == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 2);
  png_write_info(png, info);
  if (bits == 16) png_set_swap(png);
  // Every row buffer is long enough for 16-bit RGBA.
  std::vector<std::vector<std::byte>> rows(picture.shape.height_px,
                                           std::vector<std::byte>(std::size_t{picture.shape.width_px} * 8));
  std::vector<png_bytep> pointers;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    if (!picture.pixels.empty())
      std::memcpy(rows[row].data(), picture.pixels.data() + row * picture.shape.row_bytes(), picture.shape.row_bytes());
    pointers.push_back(reinterpret_cast<png_bytep>(rows[row].data()));
  }
  png_write_image(png, pointers.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(handle);
}

}  // namespace

void write_odd_png(const std::filesystem::path& file, int colour_type, int bits) {
  write_with_libpng(file, {{16, 12, 1}, {}}, colour_type, bits, PNG_INTERLACE_NONE);
}

void write_interlaced_png(const std::filesystem::path& file, const Picture& picture) {
  write_with_libpng(file, picture, PNG_COLOR_TYPE_GRAY, static_cast<int>(picture.shape.bytes_per_pixel * 8),
                    PNG_INTERLACE_ADAM7);
}

Picture read_picture(const std::filesystem::path& file, std::size_t page) {
  const auto reader = open_image(file);
  Picture picture{reader->header(page).shape, {}};
  picture.pixels.resize(picture.shape.bytes());
  reader->decode(page, picture.pixels);
  return picture;
}

TemporaryFolder::TemporaryFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "rptv-replay-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  path_ = name;
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream(file, std::ios::binary) << text;
}

void cut_short(const std::filesystem::path& file, double fraction) {
  const auto size = static_cast<double>(std::filesystem::file_size(file));
  std::filesystem::resize_file(file, static_cast<std::uintmax_t>(size * fraction));
}

}  // namespace rptv::testing
