// SPDX-License-Identifier: MIT
// Big-endian words and bound sockets of the test camera.
#pragma once

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

namespace rptv {

inline constexpr std::uint16_t kGvcpPort = 3956;

inline void put16(std::uint8_t* at, std::size_t value) {
  const std::uint16_t wire = htons(static_cast<std::uint16_t>(value));
  std::memcpy(at, &wire, 2);
}
inline void put32(std::uint8_t* at, std::uint64_t value) {
  const std::uint32_t wire = htonl(static_cast<std::uint32_t>(value));
  std::memcpy(at, &wire, 4);
}
inline std::uint16_t get16(const std::uint8_t* at) { return static_cast<std::uint16_t>(at[0] << 8 | at[1]); }
inline std::uint32_t get32(const std::uint8_t* at) {
  return static_cast<std::uint32_t>(get16(at)) << 16 | static_cast<std::uint32_t>(get16(at + 2));
}

/// UDP. `shared`: several sockets may have the same address (broadcasts reach each of them).
inline int bound_socket(const std::string& address, std::uint16_t port, bool shared = false) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int yes = 1, bytes = 4 << 20;
  if (shared) setsockopt(descriptor, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  inet_pton(AF_INET, address.c_str(), &at.sin_addr);
  if (descriptor < 0 || bind(descriptor, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0) {
    if (descriptor >= 0) close(descriptor);
    throw std::runtime_error("the test camera cannot bind " + address + ":" + std::to_string(port));
  }
  return descriptor;
}

}  // namespace rptv
