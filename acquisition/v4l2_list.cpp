// SPDX-License-Identifier: MIT
// Capture devices of the kernel, and the pixel formats that they offer.
#include <linux/videodev2.h>

#include <cerrno>
#include <system_error>

#include "acquisition/found_camera.hpp"

namespace rptv {
namespace {

constexpr int kMostDevices = 64;  // of the kernel's minor numbers for video

std::string text_of(const unsigned char* text, std::size_t most) {
  std::string all(reinterpret_cast<const char*>(text), most);
  return all.substr(0, all.find('\0'));
}

/// "GREY", without the blanks at the end of short codes; the highest bit means big-endian words, which are not taken.
std::string name_of_fourcc(std::uint32_t code) {
  std::string name;
  for (int shift = 0; shift < 32; shift += 8) name += static_cast<char>((code >> shift) & 0x7f);
  name.erase(name.find_last_not_of(' ') + 1);
  return (code >> 31) != 0 ? name + "-BE" : name;
}

bool describe(V4l2System& system, int descriptor, FoundCamera& found) {
  v4l2_capability capability{};
  if (system.ioctl(descriptor, VIDIOC_QUERYCAP, &capability) != 0) return false;
  const std::uint32_t can =
      (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
  if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0 || (can & V4L2_CAP_STREAMING) == 0) return false;
  found.vendor = text_of(capability.driver, sizeof capability.driver);
  found.model = text_of(capability.card, sizeof capability.card);
  found.serial = text_of(capability.bus_info, sizeof capability.bus_info);
  v4l2_fmtdesc format{};
  format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  for (; system.ioctl(descriptor, VIDIOC_ENUM_FMT, &format) == 0; ++format.index)
    found.formats.push_back(name_of_fourcc(format.pixelformat));
  return true;
}

}  // namespace

std::vector<FoundCamera> find_v4l2_cameras(V4l2System& system) {
  std::vector<FoundCamera> all;
  for (int number = 0; number < kMostDevices; ++number) {
    FoundCamera found;
    found.bus = "V4L2";
    found.address = "/dev/video" + std::to_string(number);
    const int descriptor = system.open(found.address.c_str());
    if (descriptor < 0) {
      if (errno == ENOENT || errno == ENXIO || errno == ENODEV) continue;
      found.problem = std::generic_category().message(errno);
      all.push_back(std::move(found));
      continue;
    }
    if (describe(system, descriptor, found)) all.push_back(std::move(found));
    system.close(descriptor);
  }
  return all;
}

}  // namespace rptv
