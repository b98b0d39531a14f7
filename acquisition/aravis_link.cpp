// SPDX-License-Identifier: MIT
// Packet socket or plain one, receive buffer and resend of a GigE Vision stream.
#include "acquisition/aravis_link.hpp"

#include <arpa/inet.h>
#include <arv.h>
#include <sys/socket.h>

#include <charconv>
#include <filesystem>

#include "core/descriptor.hpp"

namespace rptv {
namespace {

constexpr int kSocketBuffer = 8 << 20;

// The right that Aravis needs for its packet socket; a socket of no protocol hears nothing.
bool may_use_packet_sockets() { return Descriptor(socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC, 0)).open(); }

bool is_packet_socket(int descriptor) noexcept {
  int domain = 0;
  socklen_t size = sizeof domain;
  return getsockopt(descriptor, SOL_SOCKET, SO_DOMAIN, &domain, &size) == 0 && domain == AF_PACKET;
}

/// Calls `look` with every open file until it says true.
template <class Look>
void look_through_files(const Look& look) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", ignored)) {
    const std::string name = entry.path().filename().string();
    int descriptor = -1;
    std::from_chars(name.data(), name.data() + name.size(), descriptor);
    if (look(descriptor)) return;
  }
}

// Aravis keeps the stream's socket to itself, so it is found among the open files by its address. -1: not found.
int socket_of(ArvCamera* camera, ArvStream* stream) {
  GSocketAddress* local = arv_gv_device_get_interface_address(ARV_GV_DEVICE(arv_camera_get_device(camera)));
  sockaddr_in wanted{};
  if (!g_socket_address_to_native(local, &wanted, sizeof wanted, nullptr)) return -1;
  wanted.sin_port = htons(arv_gv_stream_get_port(ARV_GV_STREAM(stream)));
  int found = -1;
  look_through_files([&](int descriptor) {
    sockaddr_in bound{};
    socklen_t size = sizeof bound;
    const bool is_it = getsockname(descriptor, reinterpret_cast<sockaddr*>(&bound), &size) == 0 &&
                       bound.sin_family == AF_INET && bound.sin_port == wanted.sin_port &&
                       bound.sin_addr.s_addr == wanted.sin_addr.s_addr;
    if (is_it) found = descriptor;
    return is_it;
  });
  return found;
}

// Bytes that the kernel granted, 0 when nobody knows. The administrator may go beyond net.core.rmem_max. The kernel
// doubles what it is asked for, as room for its own book-keeping.
int grant_buffer(int descriptor, int wanted) {
  if (setsockopt(descriptor, SOL_SOCKET, SO_RCVBUFFORCE, &wanted, sizeof wanted) != 0)
    setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &wanted, sizeof wanted);
  int doubled = 0;
  socklen_t size = sizeof doubled;
  return getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &doubled, &size) == 0 ? doubled / 2 : 0;
}

}  // namespace

void choose_socket(ArvCamera* camera, const AravisSettings& settings) {
  if (!arv_camera_is_gv_device(camera)) return;
  arv_camera_gv_set_stream_options(
      camera, settings.packet_socket ? ARV_GV_STREAM_OPTION_NONE : ARV_GV_STREAM_OPTION_PACKET_SOCKET_DISABLED);
}

std::string tune_stream(ArvCamera* camera, ArvStream* stream, const AravisSettings& settings) {
  if (!ARV_IS_GV_STREAM(stream)) return {};
  g_object_set(stream, "packet-resend",
               settings.packet_resend ? ARV_GV_STREAM_PACKET_RESEND_ALWAYS : ARV_GV_STREAM_PACKET_RESEND_NEVER,
               nullptr);
  const std::string resend = settings.packet_resend ? ", resend on" : ", resend off";
  if (settings.packet_socket && may_use_packet_sockets()) return ", packet socket" + resend;
  const int wanted = settings.socket_buffer_bytes > 0 ? static_cast<int>(settings.socket_buffer_bytes) : kSocketBuffer;
  const int granted = grant_buffer(socket_of(camera, stream), wanted);
  return ", socket buffer " + std::to_string(granted) + " of " + std::to_string(wanted) + " bytes" + resend;
}

std::vector<int> packet_sockets() {
  std::vector<int> found;
  look_through_files([&](int descriptor) {
    if (is_packet_socket(descriptor)) found.push_back(descriptor);
    return false;
  });
  return found;
}

void clear_errors(const std::vector<int>& descriptors) noexcept {
  for (const int descriptor : descriptors) {
    int error = 0;
    socklen_t size = sizeof error;
    // Reading it is clearing it.
    if (is_packet_socket(descriptor)) getsockopt(descriptor, SOL_SOCKET, SO_ERROR, &error, &size);
  }
}

}  // namespace rptv
