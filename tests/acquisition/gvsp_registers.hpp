// SPDX-License-Identifier: MIT
// Registers and description of the test camera: Aravis' fake camera, with packed pixels, PTP and actions added.
#pragma once

#include <arv.h>

#include <string>
#include <utility>

#include "tests/proto/place.hpp"

namespace rptv {

inline constexpr std::uint32_t kActionDeviceKey = 0x2010, kActionSelector = 0x2014, kActionGroupKey = 0x2018,
                               kActionGroupMask = 0x201c;
inline constexpr std::uint32_t kChunkMode = 0x2020, kChunkSelector = 0x2024, kChunkEnable = 0x2028;
inline constexpr std::uint32_t kFrameIdChunk = 0, kExposureChunk = 1;  ///< selector, and chunk id less kChunkIds
inline constexpr std::uint32_t kChunkIds = 0x5000;
inline constexpr double kExposureInChunk_us = 1234.5;
inline constexpr std::uint32_t kPtpEnable = 0x2000, kPtpStatus = 0x2004, kPtpOffset = 0x2008, kPtpLatch = 0x200c;

/// A register of four bytes as the description has it.
inline std::string register_node(const std::string& name, std::uint32_t address) {
  return "<IntReg Name=\"" + name + "\"><Address>" + std::to_string(address) +
         "</Address><Length>4</Length><AccessMode>RW</AccessMode><pPort>Device</pPort><Sign>Signed</Sign>"
         "<Endianess>BigEndian</Endianess></IntReg>\n";
}

inline std::string ptp_nodes() {
  return "<Boolean Name=\"PtpEnable\"><pValue>PtpEnableRegister</pValue></Boolean>\n"
         "<Command Name=\"PtpDataSetLatch\"><pValue>PtpLatchRegister</pValue><CommandValue>1</CommandValue></Command>\n"
         "<Enumeration Name=\"PtpStatus\"><EnumEntry Name=\"Disabled\"><Value>0</Value></EnumEntry>"
         "<EnumEntry Name=\"Listening\"><Value>1</Value></EnumEntry><EnumEntry "
         "Name=\"Slave\"><Value>2</Value></EnumEntry>"
         "<pValue>PtpStatusRegister</pValue></Enumeration>\n" +
         register_node("PtpEnableRegister", kPtpEnable) + register_node("PtpLatchRegister", kPtpLatch) +
         register_node("PtpStatusRegister", kPtpStatus) + register_node("PtpOffsetFromMaster", kPtpOffset);
}

// An image behind which chunks come is a chunk itself: each has its id and its length behind it, 8 bytes.
inline std::string chunk_nodes() {
  const auto port = [](const std::string& name, const char* id) {
    return "<Port Name=\"" + name + "Port\"><ChunkID>" + id + "</ChunkID></Port>\n";
  };
  const auto value = [](const std::string& kind, const std::string& name, int bytes) {
    return "<" + kind + " Name=\"Chunk" + name + "\"><Address>0</Address><Length>" + std::to_string(bytes) +
           "</Length><AccessMode>RO</AccessMode><pPort>" + name + "Port</pPort><Endianess>BigEndian</Endianess></" +
           kind + ">\n";
  };
  return "<Boolean Name=\"ChunkModeActive\"><pValue>ChunkModeRegister</pValue></Boolean>\n"
         "<Boolean Name=\"ChunkEnable\"><pValue>ChunkEnableRegister</pValue></Boolean>\n"
         "<Enumeration Name=\"ChunkSelector\"><EnumEntry Name=\"FrameID\"><Value>0</Value></EnumEntry>"
         "<EnumEntry Name=\"ExposureTime\"><Value>1</Value></EnumEntry><pValue>ChunkSelectorRegister</pValue>"
         "</Enumeration>\n"
         "<IntReg Name=\"ChunkEnableRegister\"><Address>" +
         std::to_string(kChunkEnable) +
         "</Address><pIndex Offset=\"4\">ChunkSelectorRegister</pIndex><Length>4</Length><AccessMode>RW</AccessMode>"
         "<pPort>Device</pPort><Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>\n" +
         register_node("ChunkModeRegister", kChunkMode) + register_node("ChunkSelectorRegister", kChunkSelector) +
         register_node("ChunkFrameIDEnabled", kChunkEnable) +
         register_node("ChunkExposureTimeEnabled", kChunkEnable + 4) + port("FrameID", "5000") +
         port("ExposureTime", "5001") + value("IntReg", "FrameID", 8) + value("FloatReg", "ExposureTime", 8);
}

inline std::string action_nodes() {
  return register_node("ActionDeviceKey", kActionDeviceKey) + register_node("ActionSelector", kActionSelector) +
         register_node("ActionGroupKey", kActionGroupKey) + register_node("ActionGroupMask", kActionGroupMask);
}

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
  xml.insert(xml.find("<Port Name=\"Device\""), ptp_nodes() + action_nodes() + chunk_nodes());
  const std::string payload = "<Formula>WIDTH * HEIGHT * ((PIXELFORMAT>>16)&amp;0xFF) / 8</Formula>";
  xml.replace(xml.find(payload), payload.size(),
              "<pVariable Name=\"CHUNKS\">ChunkModeRegister</pVariable><pVariable Name=\"ID\">ChunkFrameIDEnabled"
              "</pVariable><pVariable Name=\"EXPOSURE\">ChunkExposureTimeEnabled</pVariable><Formula>WIDTH * HEIGHT * "
              "((PIXELFORMAT>>16)&amp;0xFF) / 8 + CHUNKS * (8 + 16 * (ID + EXPOSURE))</Formula>");
  xml.insert(xml.find("<pValue>TriggerSourceRegister</pValue>"),
             "<EnumEntry Name=\"Action1\" NameSpace=\"Standard\"><Value>2</Value></EnumEntry>\n");
  const Place place;
  return arv_fake_camera_new_full(serial.c_str(), place.write("camera.xml", xml).c_str());
}

}  // namespace rptv
