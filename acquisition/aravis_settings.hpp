// SPDX-License-Identifier: MIT
// Settings of GenICam cameras behind Aravis: section [aravis] of the configuration.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

/// One set of settings for all cameras of the list.
struct AravisSettings {
  static constexpr std::int64_t kWord = 0xffffffff;
  std::vector<std::string> cameras;
  std::string ownership = "host";
  std::string user_set;
  std::string pixel_format = "Mono8";
  std::vector<double> region;
  std::int64_t binning = 0;
  double exposure_us = 0;
  double gain = -1;
  double rate_hz = 0;
  std::string trigger = "off";
  std::int64_t action_device_key = 0, action_group_key = 0, action_group_mask = 1;
  std::vector<std::string> chunks;
  bool ptp = false;
  double ptp_wait_s = 15;
  std::int64_t packet_size = 0;
  std::int64_t socket_buffer_bytes = 0;
  bool packet_socket = true;
  bool packet_resend = true;
  std::int64_t thread_priority = 0;

  void fields(FieldList& list) {
    list.texts("cameras", cameras,
               "addresses, serial numbers or names as 'rapidptv cameras' lists them; best addresses");
    list.choice("ownership", ownership, {"host", "camera"},
                "host: the settings below are written to the camera; camera: it keeps what it has, or loads user_set");
    list.text("user_set", user_set, "ownership 'camera': the user set to load; empty: leave the camera as it is");
    list.text("pixel_format", pixel_format,
              "Mono8, Mono10, Mono12, Mono16, Mono10p, Mono12p, Mono10Packed or Mono12Packed");
    list.numbers("region", region, 0, 0, 65536, "x, y, width, height in px; empty: as the camera has it");
    list.integer("binning", binning, 0, 16, "pixels joined in x and in y; 0: as the camera has it");
    list.number("exposure_us", exposure_us, 0, 1e8, "exposure time; 0: as the camera has it");
    list.number("gain", gain, -1, 100, "gain in the camera's unit, mostly dB; -1: as the camera has it");
    list.number("rate_hz", rate_hz, 0, 1e5,
                "frames per second, without trigger or by the software trigger; 0: as the camera has it");
    list.text("trigger", trigger,
              "off, software (fired by this program at rate_hz), or the camera's name of a source: Line1, Action1");
    list.integer("action_device_key", action_device_key, 0, kWord,
                 "trigger Action1 and so on: the sender's device key");
    list.integer("action_group_key", action_group_key, 0, kWord, "group key of the action commands that trigger");
    list.integer("action_group_mask", action_group_mask, 0, kWord, "group mask: one common bit is enough");
    list.texts(
        "chunks", chunks,
        "what the camera writes behind each image, its names: ExposureTime, FrameID; empty: as the camera has it");
    list.flag("ptp", ptp, "set the cameras' clocks by PTP, and wait until they are locked");
    list.number("ptp_wait_s", ptp_wait_s, 0, 600, "how long to wait for a locked clock");
    list.integer("packet_size", packet_size, 0, 65536, "GigE Vision packet, bytes with IP header; 0: negotiated");
    list.integer("socket_buffer_bytes", socket_buffer_bytes, 0, 1 << 30,
                 "receive buffer where no packet socket is used; 0: 8 MiB; bounded by net.core.rmem_max");
    list.flag("packet_socket", packet_socket,
              "receive GigE Vision packets by a packet socket where that is permitted (CAP_NET_RAW)");
    list.flag("packet_resend", packet_resend, "ask GigE Vision cameras for lost packets again");
    list.integer("thread_priority", thread_priority, 0, 99, "real-time priority of the receiving threads; 0: leave");
  }
};

}  // namespace rptv
