// SPDX-License-Identifier: MIT
// Registers and description of the test camera: Aravis' fake camera, with packed pixel formats added.
#pragma once

#include <arv.h>

#include <string>
#include <utility>

#include "tests/proto/place.hpp"

namespace rptv {

/// The caller owns it.
inline ArvFakeCamera* make_gvsp_registers(const std::string& serial) {
  ArvFakeCamera* plain = arv_fake_camera_new("SIM0");
  gsize bytes = 0;
  const char* text = arv_fake_camera_get_genicam_xml(plain, &bytes);
  std::string xml(text, bytes);
  g_object_unref(plain);
  std::string entries;
  for (const auto& [name, code] :
       {std::pair{"Mono10p", 0x010A0046}, {"Mono12p", 0x010C0047}, {"Mono12Packed", 0x010C0006}})
    entries += std::string("<EnumEntry Name=\"") + name + "\" NameSpace=\"Standard\"><Value>" + std::to_string(code) +
               "</Value></EnumEntry>\n";
  xml.insert(xml.find("<pValue>PixelFormatRegister</pValue>"), entries);
  const Place place;
  return arv_fake_camera_new_full(serial.c_str(), place.write("camera.xml", xml).c_str());
}

}  // namespace rptv
