// SPDX-License-Identifier: MIT
// GVCP discovery commands, sent to one address or to all of each network, and their answers.
#include "acquisition/gvcp_probe.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <vector>

#include "core/clock.hpp"
#include "core/descriptor.hpp"

namespace rptv {
namespace {

constexpr std::uint16_t kPort = 3956;
// Key, "answer, broadcast if you must", command DISCOVERY, no payload, request id.
constexpr std::array<std::uint8_t, 8> kDiscovery{0x42, 0x11, 0x00, 0x02, 0x00, 0x00, 0x52, 0x50};
// The answer: 8 bytes of header, then the bootstrap registers from 0.
constexpr std::size_t kHeader = 8, kMac = kHeader + 10, kSerial = kHeader + 0xd8, kSerialSize = 16;

sockaddr_in at_port(in_addr address, std::uint16_t port) {
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  at.sin_addr = address;
  return at;
}

bool ask(int descriptor, in_addr whom) {
  const sockaddr_in to = at_port(whom, kPort);
  return sendto(descriptor, kDiscovery.data(), kDiscovery.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                sizeof to) == static_cast<ssize_t>(kDiscovery.size());
}

Descriptor udp_socket() { return Descriptor(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)); }

// A socket on each of this machine's addresses, its question sent to all of that network.
std::vector<Descriptor> ask_every_network() {
  std::vector<Descriptor> sockets;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return sockets;
  for (const ifaddrs* i = all; i != nullptr; i = i->ifa_next) {
    if (i->ifa_addr == nullptr || i->ifa_netmask == nullptr || i->ifa_addr->sa_family != AF_INET ||
        (i->ifa_flags & IFF_UP) == 0)
      continue;
    const in_addr mine = reinterpret_cast<const sockaddr_in*>(i->ifa_addr)->sin_addr;
    const in_addr mask = reinterpret_cast<const sockaddr_in*>(i->ifa_netmask)->sin_addr;
    const sockaddr_in from = at_port(mine, 0);
    Descriptor one = udp_socket();
    const int yes = 1;
    if (setsockopt(one.get(), SOL_SOCKET, SO_BROADCAST, &yes, sizeof yes) == 0 &&
        bind(one.get(), reinterpret_cast<const sockaddr*>(&from), sizeof from) == 0 &&
        ask(one.get(), in_addr{mine.s_addr | ~mask.s_addr}))
      sockets.push_back(std::move(one));
  }
  freeifaddrs(all);
  return sockets;
}

// Who spoke and from where, when it was the answer to our question.
bool read_answer(int descriptor, GvcpIdentity& who, std::string& where) {
  std::array<std::uint8_t, 576> answer{};
  sockaddr_in from{};
  socklen_t size = sizeof from;
  const ssize_t got = recvfrom(descriptor, answer.data(), answer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
  const bool is_ours = got >= static_cast<ssize_t>(kSerial + kSerialSize) && answer[2] == 0x00 && answer[3] == 0x03 &&
                       std::equal(answer.begin() + 6, answer.begin() + 8, kDiscovery.begin() + 6);
  if (!is_ours) return false;
  who.mac = 0;
  for (std::size_t i = 0; i < 6; ++i) who.mac = who.mac << 8 | answer[kMac + i];
  const char* serial = reinterpret_cast<const char*>(&answer[kSerial]);
  who.serial.assign(serial, strnlen(serial, kSerialSize));
  std::array<char, INET_ADDRSTRLEN> text{};
  inet_ntop(AF_INET, &from.sin_addr, text.data(), text.size());
  where = text.data();
  return true;
}

using Found = std::function<bool(const GvcpIdentity&, const std::string& where)>;

void listen(const std::vector<Descriptor>& sockets, std::int64_t patience_ns, const Found& found) {
  std::vector<pollfd> waiting;
  for (const Descriptor& one : sockets) waiting.push_back({one.get(), POLLIN, 0});
  const std::int64_t deadline_ns = host_now_ns() + patience_ns;
  for (std::int64_t left_ns = patience_ns; left_ns > 0; left_ns = deadline_ns - host_now_ns()) {
    const timespec rest{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
    if (ppoll(waiting.data(), waiting.size(), &rest, nullptr) <= 0) continue;
    for (const pollfd& one : waiting) {
      GvcpIdentity who;
      std::string where;
      if (one.revents != 0 && read_answer(one.fd, who, where) && found(who, where)) return;
    }
  }
}

}  // namespace

GvcpIdentity who_answers_at(const std::string& address, std::int64_t patience_ns) {
  GvcpIdentity result;
  in_addr whom{};
  std::vector<Descriptor> sockets;
  sockets.push_back(udp_socket());
  if (inet_pton(AF_INET, address.c_str(), &whom) != 1 || !ask(sockets[0].get(), whom)) return result;
  listen(sockets, patience_ns, [&](const GvcpIdentity& who, const std::string& where) {
    if (where == address) result = who;
    return where == address;
  });
  return result;
}

std::string find_address_of(const GvcpIdentity& identity, std::int64_t patience_ns) {
  std::string result;
  listen(ask_every_network(), patience_ns, [&](const GvcpIdentity& who, const std::string& where) {
    if (who == identity) result = where;
    return who == identity;
  });
  return result;
}

}  // namespace rptv
