// SPDX-License-Identifier: MIT
// GVCP commands of the test camera: discovery, registers, memory, and packets asked for again.
#include <sys/socket.h>

#include <algorithm>
#include <cstring>

#include "tests/acquisition/gvsp_device.hpp"
#include "tests/acquisition/gvsp_registers.hpp"
#include "tests/acquisition/gvsp_wire.hpp"

namespace rptv {

bool GvspDevice::obey(std::uint16_t command, const std::uint8_t* request, std::size_t size, std::uint8_t* reply,
                      std::size_t& length) {
  switch (command) {
    case 0x0002:  // discovery
      length = 0xf8;
      return arv_fake_camera_read_memory(registers_, 0, 0xf8, reply);
    case 0x0040:
      if (size >= 20 && faults_.answers_resend) resend(request);
      return false;
    case 0x0100:  // action
      if (size >= 20 && is_for_us(request + 8)) ++pulled_;
      return false;
    case 0x0080:  // read registers
      for (std::size_t i = 0; i + 4 <= size - 8; i += 4, length += 4) put32(reply + i, reg(get32(request + 8 + i)));
      return true;
    case 0x0082: {  // write registers
      std::size_t count = 0;
      for (std::size_t i = 8; i + 8 <= size; i += 8, ++count) write(get32(request + i), get32(request + i + 4));
      put32(reply, count);
      length = 4;
      return true;
    }
    case 0x0084: {  // read memory
      const std::uint32_t count = std::min(get32(request + 12) & 0xffffU, 1024U);
      std::memcpy(reply, request + 8, 4);
      arv_fake_camera_read_memory(registers_, get32(request + 8), count, reply + 4);
      length = count + 4;
      return true;
    }
    case 0x0086:  // write memory
      arv_fake_camera_write_memory(registers_, get32(request + 8), static_cast<std::uint32_t>(size - 12), request + 12);
      put32(reply, size - 12);
      length = 4;
      return true;
    default:
      return false;
  }
}

void GvspDevice::write(std::uint32_t address, std::uint32_t value) {
  arv_fake_camera_write_register(registers_, address, value);
  if (address == ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOFTWARE && reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0 &&
      reg(ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE) != 0 && reg(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE) == 1)
    ++pulled_;
}

bool GvspDevice::is_for_us(const std::uint8_t* action) {
  return reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0 && reg(ARV_FAKE_CAMERA_REGISTER_TRIGGER_SOURCE) == 2 &&
         get32(action) == reg(kActionDeviceKey) && get32(action + 4) == reg(kActionGroupKey) &&
         (get32(action + 8) & reg(kActionGroupMask)) != 0;
}

void GvspDevice::answer(int descriptor) {
  std::uint8_t request[2048], reply[2048];
  sockaddr_in from{};
  for (;;) {
    socklen_t from_size = sizeof from;
    const ssize_t got =
        recvfrom(descriptor, request, sizeof request, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &from_size);
    if (got < 8) return;
    std::size_t length = 0;
    const std::uint16_t command = get16(request + 2);
    if (request[0] != 0x42 || !obey(command, request, static_cast<std::size_t>(got), reply + 8, length)) continue;
    put16(reply, 0);
    put16(reply + 2, command + 1U);
    put16(reply + 4, length);
    std::memcpy(reply + 6, request + 6, 2);
    if (truth_.first_answer_ns == 0) truth_.first_answer_ns = host_now_ns();
    sendto(control_, reply, length + 8, 0, reinterpret_cast<const sockaddr*>(&from), from_size);
  }
}

void GvspDevice::resend(const std::uint8_t* request) {
  const std::uint32_t last = get32(request + 16) & 0xffffffU;
  for (const Image& image : recent_)
    if (image.id == get16(request + 10))
      for (std::uint32_t k = get32(request + 12) & 0xffffffU; k <= std::min(last, image.last); ++k, ++truth_.resent)
        send_packet(image, k);
}

}  // namespace rptv
