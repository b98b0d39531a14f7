// SPDX-License-Identifier: MIT
// Image files on disk: mono 8/16-bit PNG and TIFF decoded straight into a caller's buffer, and PNG written.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "core/image.hpp"

namespace rptv {

/// Larger images are refused as damaged headers.
inline constexpr std::uint32_t kMaxImageSidePx = 65536;

struct ImageHeader {
  ImageShape shape;
  std::uint32_t significant_bits =
      8;  ///< grey values lie in 0 … 2^bits − 1; the pixel's depth unless the file says less
};

/// One open file with one image (PNG) or one per page (TIFF, BigTIFF). One thread at a time. The decoding libraries
/// allocate in decode(); nothing else does after construction.
class ImageReader {
 public:
  virtual ~ImageReader() = default;
  virtual std::size_t pages() const noexcept = 0;
  /// page < pages().
  virtual const ImageHeader& header(std::size_t page) const noexcept = 0;
  /// Fills `pixels` (header(page).shape.bytes() long) with rows from top to bottom, 16-bit values in host byte order.
  /// Throws Error(bad_data) when the file is damaged or has changed; `pixels` then holds what could be read.
  virtual void decode(std::size_t page, std::span<std::byte> pixels) = 0;
};

/// Opens a PNG or TIFF, told apart by its first bytes, and checks its structure without decoding: what is not mono 8/16
/// bit is refused, and so is a file that ends before its last chunk or strip. TIFF pages that are reduced copies
/// (thumbnails) are left out. Throws Error: no_input (missing), permission, bad_data, io; one line with the file's
/// name.
std::unique_ptr<ImageReader> open_image(const std::filesystem::path& file);

/// Writes an 8- or 16-bit grey PNG. `significant_bits` below the pixel's depth is kept in the text chunk
/// "SignificantBits" (PNG's own sBIT means values scaled up to full depth, which these are not) and read back by
/// open_image(). Throws Error(io or permission) and leaves no half-written file behind.
void write_png(const std::filesystem::path& file, const ImageView& image, std::uint32_t significant_bits = 0);

}  // namespace rptv
