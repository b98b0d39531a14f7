// SPDX-License-Identifier: MIT
// GenICam cameras that answer, and the pixel formats that they offer.
#include <arv.h>

#include "acquisition/aravis_handle.hpp"
#include "acquisition/found_camera.hpp"

namespace rptv {
namespace {

std::string text_or_none(const char* text) { return text != nullptr ? text : ""; }

void ask_formats(const std::string& name, FoundCamera& found) {
  ArvFailure failure;
  const CameraHandle camera(arv_camera_new(name.c_str(), failure.out()));
  if (!camera) {
    found.problem = failure ? failure.text() : "does not open; another program may hold it";
    return;
  }
  guint count = 0;
  const char** formats = arv_camera_dup_available_pixel_formats_as_strings(camera.get(), &count, failure.out());
  for (guint i = 0; formats != nullptr && i < count; ++i) found.formats.emplace_back(formats[i]);
  g_free(formats);
  if (failure) found.problem = failure.text();
}

}  // namespace

std::vector<FoundCamera> find_aravis_cameras() {
  std::vector<FoundCamera> all;
  arv_update_device_list();
  for (unsigned i = 0; i < arv_get_n_devices(); ++i) {
    FoundCamera found;
    found.bus = text_or_none(arv_get_device_protocol(i));
    const bool has_address = found.bus == "GigEVision";  // by name Aravis may listen on the wrong interface
    found.address = text_or_none(has_address ? arv_get_device_address(i) : arv_get_device_id(i));
    found.vendor = text_or_none(arv_get_device_vendor(i));
    found.model = text_or_none(arv_get_device_model(i));
    found.serial = text_or_none(arv_get_device_serial_nbr(i));
    all.push_back(std::move(found));
  }
  for (auto& found : all) ask_formats(found.address, found);
  return all;
}

}  // namespace rptv
