// SPDX-License-Identifier: MIT
// The table of formats.
#include "acquisition/v4l2_format.hpp"

#include <linux/videodev2.h>

#include "acquisition/unpack.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

std::size_t one_byte(std::size_t pixels) noexcept { return pixels; }
std::size_t two_bytes(std::size_t pixels) noexcept { return 2 * pixels; }

void yuyv(const std::byte* from, std::byte* to, std::size_t pixels) noexcept {
  extract_yuyv_luma(from, reinterpret_cast<std::uint8_t*>(to), pixels);
}
void mipi10(const std::byte* from, std::byte* to, std::size_t pixels) noexcept {
  unpack_mipi10(from, reinterpret_cast<std::uint16_t*>(to), pixels);
}
void mipi12(const std::byte* from, std::byte* to, std::size_t pixels) noexcept {
  unpack_mipi12(from, reinterpret_cast<std::uint16_t*>(to), pixels);
}

constexpr V4l2Format kFormats[] = {
    {"GREY", V4L2_PIX_FMT_GREY, 8, one_byte},
    {"Y10", V4L2_PIX_FMT_Y10, 10, two_bytes},
    {"Y12", V4L2_PIX_FMT_Y12, 12, two_bytes},
    {"Y16", V4L2_PIX_FMT_Y16, 16, two_bytes},
    {"Y10P", V4L2_PIX_FMT_Y10P, 10, bytes_of_mipi10, mipi10},
    {"Y12P", v4l2_fourcc('Y', '1', '2', 'P'), 12, bytes_of_mipi12, mipi12},  // newer than Debian 12's headers
    {"YUYV", V4L2_PIX_FMT_YUYV, 8, two_bytes, yuyv},
    {"NV12", V4L2_PIX_FMT_NV12, 8, one_byte, nullptr, false},
};

}  // namespace

const V4l2Format& find_v4l2_format(const std::string& name) {
  for (const V4l2Format& format : kFormats)
    if (name == format.name) return format;
  throw Error(ExitCode::configuration, "v4l2.pixel_format = '" + name + "' is not known; use GREY, Y10, Y12 or Y16");
}

}  // namespace rptv
