// SPDX-License-Identifier: MIT
// The pixel formats of V4L2 devices that become images here, and how their rows become rows of ours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace rptv {

struct V4l2Format {
  using RowBytes = std::size_t (*)(std::size_t pixels) noexcept;
  using Unpack = void (*)(const std::byte* from, std::byte* to, std::size_t pixels) noexcept;

  const char* name;      ///< as v4l2-ctl shows it
  std::uint32_t fourcc;  ///< the kernel's code
  std::uint32_t significant_bits;
  RowBytes row_bytes;       ///< of the luma, without padding
  Unpack unpack = nullptr;  ///< of a row; null: it is a row of ours as it is
  bool only_luma = true;    ///< nothing follows the luma: the buffer is the image where rows have no padding
};

/// Throws Error(configuration) for a name that is not known.
const V4l2Format& find_v4l2_format(const std::string& name);

}  // namespace rptv
