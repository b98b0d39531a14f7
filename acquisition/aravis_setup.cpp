// SPDX-License-Identifier: MIT
// Writes the settings of [aravis] to a camera, feature by feature, and reads back what it made of them.
#include "acquisition/aravis_setup.hpp"

#include <arv.h>

#include <cmath>
#include <cstdlib>

#include "acquisition/aravis_ptp.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

class Writer {
 public:
  Writer(ArvCamera* camera, const std::string& name) : camera_(camera), name_(name) {}

  /// `key` names the setting and its value in the message.
  template <class Call>
  void write(const std::string& key, const Call& call) {
    ArvFailure failure;
    call(camera_, failure.out());
    if (!failure) return;
    const std::string text = failure.text();
    if (text.find("privilege") != std::string::npos || text.find("access-denied") != std::string::npos)
      throw Error(ExitCode::unavailable,
                  "camera " + name_ + " is controlled by another program (" + text + "); close the other program");
    if (text.find("imeout") != std::string::npos)
      throw Error(ExitCode::unavailable,
                  "camera " + name_ + " stopped answering (" + text + "); check cable and power");
    throw Error(ExitCode::configuration, "camera " + name_ + " refuses aravis." + key + " (" + text +
                                             "); mend the value, or set aravis.ownership = 'camera'");
  }

 private:
  ArvCamera* camera_;
  const std::string& name_;
};

// "Action1" listens to action commands by selector 1.
void write_action(Writer& writer, const AravisSettings& s) {
  const auto set = [&](const char* feature, std::int64_t value) {
    writer.write("trigger = " + s.trigger + " (" + feature + ")",
                 [&](ArvCamera* camera, GError** error) { arv_camera_set_integer(camera, feature, value, error); });
  };
  set("ActionDeviceKey", s.action_device_key);
  set("ActionSelector", std::strtoll(s.trigger.c_str() + s.trigger.find_first_of("0123456789"), nullptr, 10));
  set("ActionGroupKey", s.action_group_key);
  set("ActionGroupMask", s.action_group_mask);
}

void write_chunks(Writer& writer, const std::vector<std::string>& chunks) {
  std::string list;
  for (const std::string& chunk : chunks) list += (list.empty() ? "" : ",") + chunk;
  writer.write("chunks = " + list,
               [&](ArvCamera* camera, GError** error) { arv_camera_set_chunks(camera, list.c_str(), error); });
}

bool is_action(const std::string& trigger) {
  return trigger.rfind("Action", 0) == 0 && trigger.find_first_of("0123456789") != std::string::npos;
}

void write_settings(Writer& writer, const AravisSettings& s) {
  writer.write("pixel_format = " + s.pixel_format, [&](ArvCamera* camera, GError** error) {
    arv_camera_set_pixel_format_from_string(camera, s.pixel_format.c_str(), error);
  });
  if (s.binning > 0)
    writer.write("binning = " + std::to_string(s.binning), [&](ArvCamera* camera, GError** error) {
      arv_camera_set_binning(camera, static_cast<gint>(s.binning), static_cast<gint>(s.binning), error);
    });
  if (!s.region.empty())
    writer.write("region", [&](ArvCamera* camera, GError** error) {
      const auto at = [&](std::size_t i) { return static_cast<gint>(s.region[i]); };
      arv_camera_set_region(camera, at(0), at(1), at(2), at(3), error);
    });
  if (s.exposure_us > 0)
    writer.write("exposure_us", [&](ArvCamera* camera, GError** error) {
      arv_camera_set_exposure_time(camera, s.exposure_us, error);
    });
  if (s.gain >= 0)
    writer.write("gain", [&](ArvCamera* camera, GError** error) { arv_camera_set_gain(camera, s.gain, error); });
  if (!s.chunks.empty()) write_chunks(writer, s.chunks);
  if (is_action(s.trigger)) write_action(writer, s);
  if (s.trigger != "off") {
    const std::string source = s.trigger == "software" ? "Software" : s.trigger;
    writer.write("trigger = " + s.trigger,
                 [&](ArvCamera* camera, GError** error) { arv_camera_set_trigger(camera, source.c_str(), error); });
  } else if (s.rate_hz > 0) {
    writer.write("rate_hz",
                 [&](ArvCamera* camera, GError** error) { arv_camera_set_frame_rate(camera, s.rate_hz, error); });
  }
  writer.write("trigger (AcquisitionMode)", [](ArvCamera* camera, GError** error) {
    arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, error);
  });
}

void set_packets(Writer& writer, ArvCamera* camera, const AravisSettings& s) {
  if (s.packet_size > 0) {
    writer.write("packet_size", [&](ArvCamera* c, GError** error) {
      arv_camera_gv_set_packet_size(c, static_cast<gint>(s.packet_size), error);
    });
    return;
  }
  // A camera that knows no test packets keeps the size that it has: no reason to refuse it.
  ArvFailure ignored;
  arv_camera_gv_auto_packet_size(camera, ignored.out());
}

std::string address_of(ArvCamera* camera) {
  GSocketAddress* address = arv_gv_device_get_device_address(ARV_GV_DEVICE(arv_camera_get_device(camera)));
  char* text = g_inet_address_to_string(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address)));
  std::string dotted = text;
  g_free(text);
  return dotted;
}

std::string text_of(const char* text) { return text == nullptr ? "?" : text; }

}  // namespace

std::string AravisSetup::text() const {
  std::string all = std::string(format->name) + " " + std::to_string(shape.width_px) + " x " +
                    std::to_string(shape.height_px) + " px";
  if (exposure_us > 0) all += ", exposure " + std::to_string(std::llround(exposure_us)) + " us";
  if (bytes_behind_image > 0) all += ", " + std::to_string(bytes_behind_image) + " bytes of chunks";
  if (packet_size > 0) all += ", packets of " + std::to_string(packet_size) + " bytes";
  return all;
}

CameraHandle open_camera(const std::string& name) {
  ArvFailure failure;
  CameraHandle camera(arv_camera_new(name.c_str(), failure.out()));
  if (camera) return camera;
  const std::string reason = failure ? failure.text() : "not found";
  throw Error(ExitCode::unavailable, "camera " + name + " does not answer (" + reason +
                                         "); check power, cable and address: 'rapidptv cameras' lists what answers");
}

AravisSetup set_up_camera(ArvCamera* camera, const std::string& name, const AravisSettings& settings) {
  Writer writer(camera, name);
  AravisSetup setup;
  ArvFailure ignored;
  if (arv_camera_is_gv_device(camera) && !arv_gv_device_is_controller(ARV_GV_DEVICE(arv_camera_get_device(camera))))
    throw Error(ExitCode::unavailable, "camera " + name + " is controlled by another program; close the other program");
  setup.device = text_of(arv_camera_get_vendor_name(camera, ignored.out())) + " " +
                 text_of(arv_camera_get_model_name(camera, ignored.out())) + " " +
                 text_of(arv_camera_get_device_serial_number(camera, ignored.out()));
  if (arv_camera_is_gv_device(camera)) setup.address = address_of(camera);
  setup.device += " at " + (setup.address.empty() ? name : setup.address);
  if (settings.ownership == "host")
    write_settings(writer, settings);
  else if (!settings.user_set.empty())
    writer.write("user_set = " + settings.user_set, [&](ArvCamera* c, GError** error) {
      arv_camera_set_string(c, "UserSetSelector", settings.user_set.c_str(), error);
      if (error == nullptr || *error == nullptr) arv_camera_execute_command(c, "UserSetLoad", error);
    });
  if (settings.ptp) enable_ptp(camera, name);
  if (arv_camera_is_gv_device(camera)) {
    set_packets(writer, camera, settings);
    setup.packet_size = arv_camera_gv_get_packet_size(camera, ignored.out());
  }
  setup.wide_ids = !arv_camera_is_gv_device(camera);
  writer.write("pixel_format (reading)", [&](ArvCamera* c, GError** error) {
    const char* format = arv_camera_get_pixel_format_as_string(c, error);
    if (format == nullptr) return;
    setup.format = find_pixel_format(format);
    if (setup.format == nullptr)
      throw Error(ExitCode::configuration,
                  "camera " + name + " has pixel format " + format +
                      "; set aravis.pixel_format to Mono8, Mono10, Mono12, Mono16, Mono10p, Mono12p, "
                      "Mono10Packed or Mono12Packed");
  });
  gint x = 0, y = 0, width = 0, height = 0;
  writer.write("region (reading)",
               [&](ArvCamera* c, GError** error) { arv_camera_get_region(c, &x, &y, &width, &height, error); });
  writer.write("region (payload)",
               [&](ArvCamera* c, GError** error) { setup.payload_bytes = arv_camera_get_payload(c, error); });
  setup.shape = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height),
                 setup.format == nullptr ? 1U : setup.format->bytes_per_pixel};
  const std::size_t expected_bytes =
      setup.format == nullptr ? 0
                              : setup.format->payload_bytes(std::size_t{setup.shape.width_px} * setup.shape.height_px);
  const bool has_chunks = arv_camera_get_chunk_mode(camera, ignored.out());
  if (setup.payload_bytes < expected_bytes || (setup.payload_bytes > expected_bytes && !has_chunks))
    throw Error(ExitCode::configuration, "camera " + name + " sends " + std::to_string(setup.payload_bytes) +
                                             " bytes per image where " + std::to_string(expected_bytes) +
                                             " are expected; switch its line padding off");
  setup.bytes_behind_image = setup.payload_bytes - expected_bytes;
  setup.exposure_us = arv_camera_get_exposure_time(camera, ignored.out());
  const double rate_hz = arv_camera_get_frame_rate(camera, ignored.out());
  if (!ignored && settings.trigger == "off" && std::isfinite(rate_hz) && rate_hz > 0)
    setup.period_ns = static_cast<std::int64_t>(1e9 / rate_hz);
  if (settings.trigger == "software") setup.period_ns = static_cast<std::int64_t>(1e9 / settings.rate_hz);
  return setup;
}

}  // namespace rptv
