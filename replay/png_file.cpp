// SPDX-License-Identifier: MIT
// Grey PNG through libpng.
#include <fcntl.h>
#include <png.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include "replay/image_error.hpp"
#include "replay/image_file.hpp"

namespace rptv {
namespace {

constexpr char kBitsKey[] = "SignificantBits";
constexpr png_alloc_size_t kMaxMetadataBytes =
    8'000'000;  // per chunk, unpacked: text and colour profiles stay far below

void on_error(png_structp png, png_const_charp text) {
  auto* message = static_cast<LibraryMessage*>(png_get_error_ptr(png));
  std::snprintf(message->text.data(), message->text.size(), "%s", text);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}  // odd metadata, never pixels

struct Closer {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};
using OpenFile = std::unique_ptr<std::FILE, Closer>;

/// libpng's two structs for one pass over a file.
struct ReadSession {
  LibraryMessage message;
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &message, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  ReadSession() {
    if (info == nullptr) throw std::bad_alloc();
  }
  ReadSession(const ReadSession&) = delete;
  ReadSession& operator=(const ReadSession&) = delete;
  ~ReadSession() { png_destroy_read_struct(&png, &info, nullptr); }
};

struct WriteSession {
  LibraryMessage message;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &message, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  WriteSession() {
    if (info == nullptr) throw std::bad_alloc();
  }
  WriteSession(const WriteSession&) = delete;
  WriteSession& operator=(const WriteSession&) = delete;
  ~WriteSession() { png_destroy_write_struct(&png, &info); }
};

// The functions with setjmp hold nothing with a destructor: longjmp leaves them without unwinding.

bool read_info(ReadSession& session, std::FILE* file) noexcept {
  if (setjmp(png_jmpbuf(session.png)) != 0) return false;
  png_init_io(session.png, file);
  png_set_user_limits(session.png, kMaxImageSidePx, kMaxImageSidePx);
  png_set_chunk_malloc_max(session.png, kMaxMetadataBytes);
  png_read_info(session.png, session.info);
  return true;
}

bool read_rows(ReadSession& session, const ImageShape& shape, std::byte* pixels) noexcept {
  if (setjmp(png_jmpbuf(session.png)) != 0) return false;
  if (shape.bytes_per_pixel == 2 && std::endian::native == std::endian::little) png_set_swap(session.png);
  const int passes = png_set_interlace_handling(session.png);
  png_read_update_info(session.png, session.info);
  for (int pass = 0; pass < passes; ++pass)
    for (std::uint32_t row = 0; row < shape.height_px; ++row)
      png_read_row(session.png, reinterpret_cast<png_bytep>(pixels + row * shape.row_bytes()), nullptr);
  png_read_end(session.png, nullptr);  // the checksum of the last chunk, and that there is one
  return true;
}

std::uint32_t significant_bits(ReadSession& session, std::uint32_t depth) noexcept {
  png_textp text = nullptr;
  int count = 0;
  png_get_text(session.png, session.info, &text, &count);
  for (int i = 0; i < count; ++i) {
    if (std::strcmp(text[i].key, kBitsKey) != 0 || text[i].text == nullptr) continue;
    const long bits = std::strtol(text[i].text, nullptr, 10);
    if (bits >= 1 && bits <= static_cast<long>(depth)) return static_cast<std::uint32_t>(bits);
  }
  return depth;
}

ImageHeader header_of(ReadSession& session, const std::filesystem::path& file) {
  const png_uint_32 width = png_get_image_width(session.png, session.info);
  const png_uint_32 height = png_get_image_height(session.png, session.info);
  const std::uint32_t depth = png_get_bit_depth(session.png, session.info);
  if (png_get_color_type(session.png, session.info) != PNG_COLOR_TYPE_GRAY)
    throw image_error(file, "has colour, a palette or transparency, not one grey channel", kConvert);
  if (depth != 8 && depth != 16)
    throw image_error(file, "has " + std::to_string(depth) + " bits per pixel, not 8 or 16", kConvert);
  return {{width, height, depth / 8}, significant_bits(session, depth)};
}

/// Walks the chunk lengths to IEND: finds a file that was cut short without decoding it.
void check_complete(int fd, const std::filesystem::path& file) {
  struct stat status {};
  if (fstat(fd, &status) != 0) throw system_error(file, errno, "read");
  off_t at = 8;
  std::array<unsigned char, 8> head{};
  while (pread(fd, head.data(), head.size(), at) == static_cast<ssize_t>(head.size())) {
    at += 12 + static_cast<off_t>(png_get_uint_32(head.data()));
    if (std::memcmp(head.data() + 4, "IEND", 4) == 0 && at <= status.st_size) return;
  }
  throw image_error(file, "PNG is truncated after " + std::to_string(status.st_size) + " bytes", kCopyAgain);
}

class PngReader final : public ImageReader {
 public:
  explicit PngReader(const std::filesystem::path& path) : path_(path), file_(std::fopen(path.c_str(), "rbe")) {
    if (file_ == nullptr) throw system_error(path_, errno, "opened");
    check_complete(fileno(file_.get()), path_);  // first: a chunk can then be no longer than the file
    ReadSession session;
    header_ = start(session);
  }
  std::size_t pages() const noexcept override { return 1; }
  const ImageHeader& header(std::size_t) const noexcept override { return header_; }

  void decode(std::size_t, std::span<std::byte> pixels) override {
    std::rewind(file_.get());
    ReadSession session;
    if (start(session).shape != header_.shape || pixels.size() != header_.shape.bytes())
      throw image_error(path_, "has changed its shape since it was opened", kCopyAgain);
    if (!read_rows(session, header_.shape, pixels.data())) throw damaged(session);
  }

 private:
  ImageHeader start(ReadSession& session) {
    if (!read_info(session, file_.get())) throw damaged(session);
    return header_of(session, path_);
  }
  Error damaged(const ReadSession& session) const {
    return image_error(path_, "PNG is truncated or damaged (" + std::string(session.message.view()) + ")", kCopyAgain);
  }

  std::filesystem::path path_;
  OpenFile file_;
  ImageHeader header_;
};

bool write_all(WriteSession& session, std::FILE* file, const ImageView& image, png_textp bits) noexcept {
  if (setjmp(png_jmpbuf(session.png)) != 0) return false;
  const ImageShape& shape = image.shape;
  png_init_io(session.png, file);
  // Speed over size: a sparse 2048 x 1536 frame takes a quarter of libpng's default time and half as many bytes again.
  png_set_compression_level(session.png, 1);
  png_set_filter(session.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_compression_buffer_size(session.png, 1U << 18);
  png_set_IHDR(session.png, session.info, shape.width_px, shape.height_px, static_cast<int>(shape.bytes_per_pixel * 8),
               PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (bits != nullptr) png_set_text(session.png, session.info, bits, 1);
  png_write_info(session.png, session.info);
  if (shape.bytes_per_pixel == 2 && std::endian::native == std::endian::little) png_set_swap(session.png);
  for (std::uint32_t row = 0; row < shape.height_px; ++row)
    png_write_row(session.png, reinterpret_cast<png_const_bytep>(image.data + row * shape.row_bytes()));
  png_write_end(session.png, session.info);
  return true;
}

}  // namespace

std::unique_ptr<ImageReader> open_png(const std::filesystem::path& file) { return std::make_unique<PngReader>(file); }

void write_png(const std::filesystem::path& file, const ImageView& image, std::uint32_t bits) {
  const std::uint32_t depth = image.shape.bytes_per_pixel * 8;
  std::string key = kBitsKey;
  std::string value = std::to_string(bits);
  png_text text{};
  text.compression = PNG_TEXT_COMPRESSION_NONE;
  text.key = key.data();
  text.text = value.data();
  text.text_length = value.size();

  OpenFile handle(std::fopen(file.c_str(), "wbe"));
  if (handle == nullptr) throw system_error(file, errno, "written");
  WriteSession session;
  errno = 0;
  const bool written = write_all(session, handle.get(), image, bits > 0 && bits < depth ? &text : nullptr);
  const bool flushed = std::fclose(handle.release()) == 0;
  if (written && flushed) return;
  const int code = errno;
  if (std::filesystem::is_regular_file(file)) std::filesystem::remove(file);  // never a device node
  if (code != 0) throw system_error(file, code, "written");
  throw image_error(file, "cannot be written as PNG (" + std::string(session.message.view()) + ")",
                    "give an image of 1 to 65536 pixels a side with 1 or 2 bytes per pixel", ExitCode::internal);
}

}  // namespace rptv
