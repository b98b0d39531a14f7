// SPDX-License-Identifier: MIT
// What a user can say about V4L2 cameras.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

struct V4l2Settings {
  std::vector<std::string> devices;
  std::string pixel_format = "GREY";
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  double rate_hz = 0;
  std::int64_t buffers = 8;
  std::string memory = "auto";
  std::vector<std::string> controls;

  void fields(FieldList& list) {
    list.texts("devices", devices, "device nodes in camera order; /dev/v4l/by-id/... stays the same over a restart");
    list.choice("pixel_format", pixel_format, {"GREY", "Y10", "Y12", "Y16", "Y10P", "Y12P", "YUYV", "NV12"},
                "what the camera sends; of YUYV and NV12 the luma is used");
    list.integer("width_px", width_px, 0, 65536, "image width; 0: what the driver is set to");
    list.integer("height_px", height_px, 0, 65536, "image height; 0: what the driver is set to");
    list.number("rate_hz", rate_hz, 0, 1e6, "frames per second; 0: what the driver is set to");
    list.integer("buffers", buffers, 2, 32, "buffers that the driver fills; userptr: at most half of pool_frames");
    list.choice("memory", memory, {"auto", "userptr", "mmap"},
                "userptr: the driver writes straight into frame slots; mmap: one copy; auto: userptr where it can be");
    list.texts("controls", controls,
               "\"name=value\", set in this order whenever the device is opened; names as `v4l2-ctl -L` shows them");
  }
};

}  // namespace rptv
