// SPDX-License-Identifier: MIT
// GVCP commands and GVSP packets of the test camera, with seeded faults.
#include "tests/acquisition/gvsp_device.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "tests/acquisition/gvsp_registers.hpp"

namespace rptv {
namespace {

constexpr std::uint16_t kPort = 3956;
constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15ULL;

void put16(std::uint8_t* at, std::size_t value) {
  const std::uint16_t wire = htons(static_cast<std::uint16_t>(value));
  std::memcpy(at, &wire, 2);
}
void put32(std::uint8_t* at, std::uint64_t value) {
  const std::uint32_t wire = htonl(static_cast<std::uint32_t>(value));
  std::memcpy(at, &wire, 4);
}
std::uint16_t get16(const std::uint8_t* at) { return static_cast<std::uint16_t>(at[0] << 8 | at[1]); }
std::uint32_t get32(const std::uint8_t* at) {
  return static_cast<std::uint32_t>(get16(at)) << 16 | static_cast<std::uint32_t>(get16(at + 2));
}

int bound_socket(const std::string& address, std::uint16_t port) {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  inet_pton(AF_INET, address.c_str(), &at.sin_addr);
  if (descriptor < 0 || bind(descriptor, reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0)
    throw std::runtime_error("the test camera cannot bind " + address + ":" + std::to_string(port));
  const int bytes = 4 << 20;
  setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  return descriptor;
}

}  // namespace

void fill_image(std::uint8_t* image, std::size_t bytes, std::uint64_t sequence) {
  for (std::size_t i = 0; i + 8 <= bytes; i += 8) {
    const std::uint64_t word = i == 0 ? sequence : sequence * kStep + i;
    std::memcpy(image + i, &word, 8);
  }
}

std::uint64_t sequence_of(const std::uint8_t* image, std::size_t bytes) {
  std::uint64_t sequence = 0;
  std::memcpy(&sequence, image, 8);
  std::vector<std::uint8_t> expected(bytes);
  fill_image(expected.data(), bytes, sequence);
  return std::memcmp(expected.data(), image, bytes) == 0 ? sequence : 0;
}

GvspDevice::GvspDevice(std::string address, GvspFaults faults, std::uint64_t last_sequence)
    : faults_(faults),
      registers_(make_gvsp_registers()),
      control_(bound_socket(address, kPort)),
      stream_(bound_socket(address, 0)),
      random_(faults.seed),
      next_id_(faults.first_id),
      sequence_(last_sequence) {
  GInetAddress* inet = g_inet_address_new_from_string(address.c_str());
  arv_fake_camera_set_inet_address(registers_, inet);
  g_object_unref(inet);
  thread_ = std::thread([this] { run(); });
}

void GvspDevice::hang(std::int64_t ms) { hangs_until_ns_ = host_now_ns() + ms * 1'000'000; }

// Ends with the time, or when the device is stopped.
void GvspDevice::hang_if_told() {
  while (!stop_) {
    const std::uint32_t seen = stopped_.prepare();
    const std::int64_t left_ns = hangs_until_ns_ - host_now_ns();
    if (left_ns <= 0) return;
    stopped_.wait(seen, left_ns);
  }
}

void GvspDevice::stop() {
  stop_ = true;
  stopped_.notify();
  if (thread_.joinable()) thread_.join();
}

GvspDevice::~GvspDevice() {
  stop();
  close(control_);
  close(stream_);
  g_object_unref(registers_);
}

std::uint32_t GvspDevice::reg(std::uint32_t address) {
  std::uint32_t value = 0;
  arv_fake_camera_read_register(registers_, address, &value);
  return value;
}

void GvspDevice::run() {
  std::int64_t due_ns = host_now_ns();
  while (!stop_) {
    hang_if_told();
    const bool acquires = reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0;
    const std::int64_t now_ns = host_now_ns();
    if (!acquires) due_ns = now_ns;
    const std::int64_t rest_ns = acquires ? std::clamp<std::int64_t>(due_ns - now_ns, 0, 20'000'000) : 20'000'000;
    pollfd waiting{control_, POLLIN, 0};
    const timespec rest{0, rest_ns};
    if (ppoll(&waiting, 1, &rest, nullptr) > 0) answer();
    if (!acquires || host_now_ns() < due_ns) continue;
    send_image();
    due_ns += std::int64_t{1000} * reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US);
    due_ns = std::max(due_ns, host_now_ns() - 50'000'000);
  }
}

bool GvspDevice::obey(std::uint16_t command, const std::uint8_t* request, std::size_t size, std::uint8_t* reply,
                      std::size_t& length) {
  switch (command) {
    case 0x0002:  // discovery
      length = 0xf8;
      return arv_fake_camera_read_memory(registers_, 0, 0xf8, reply);
    case 0x0040:
      if (size >= 20 && faults_.answers_resend) resend(request);
      return false;
    case 0x0080:  // read registers
      for (std::size_t i = 0; i + 4 <= size - 8; i += 4, length += 4) put32(reply + i, reg(get32(request + 8 + i)));
      return true;
    case 0x0082: {  // write registers
      std::size_t count = 0;
      for (std::size_t i = 8; i + 8 <= size; i += 8, ++count)
        arv_fake_camera_write_register(registers_, get32(request + i), get32(request + i + 4));
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

void GvspDevice::answer() {
  std::uint8_t request[2048], reply[2048];
  sockaddr_in from{};
  for (;;) {
    socklen_t from_size = sizeof from;
    const ssize_t got =
        recvfrom(control_, request, sizeof request, MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &from_size);
    if (got < 8) return;
    std::size_t length = 0;
    const std::uint16_t command = get16(request + 2);
    if (request[0] != 0x42 || !obey(command, request, static_cast<std::size_t>(got), reply + 8, length)) continue;
    put16(reply, 0);
    put16(reply + 2, command + 1U);
    put16(reply + 4, length);
    std::memcpy(reply + 6, request + 6, 2);
    sendto(control_, reply, length + 8, 0, reinterpret_cast<const sockaddr*>(&from), from_size);
  }
}

void GvspDevice::resend(const std::uint8_t* request) {
  const std::uint32_t last = get32(request + 16) & 0xffffffU;
  for (const Image& image : recent_)
    if (image.id == get16(request + 10))
      for (std::uint32_t k = get32(request + 12) & 0xffffffU; k <= std::min(last, image.last); ++k, ++resent_)
        send_packet(image, k);
}

void GvspDevice::send_image() {
  Image image;
  image.id = next_id_;
  next_id_ = static_cast<std::uint16_t>(next_id_ == 0xffff ? 1 : next_id_ + 1);
  image.width = reg(ARV_FAKE_CAMERA_REGISTER_WIDTH);
  image.height = reg(ARV_FAKE_CAMERA_REGISTER_HEIGHT);
  image.format = reg(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT);
  image.time_ns = static_cast<std::uint64_t>(host_now_ns());
  image.chunk = (reg(0x0d04) & 0xffffU) - 36;  // IP 20, UDP 8, GVSP 8
  image.bytes.resize(std::size_t{image.width} * image.height * (image.format >> 16 & 0xffU) / 8);
  fill_image(image.bytes.data(), image.bytes.size(), sequence_ + 1);
  image.last = static_cast<std::uint32_t>((image.bytes.size() + image.chunk - 1) / image.chunk + 1);
  peer_.sin_family = AF_INET;
  peer_.sin_port = htons(static_cast<std::uint16_t>(reg(0x0d00) & 0xffffU));
  peer_.sin_addr.s_addr = htonl(reg(0x0d18));
  if (recent_.size() >= 16) recent_.pop_front();
  recent_.push_back(std::move(image));
  for (std::uint32_t k = 0; k <= recent_.back().last; ++k) send_packet(recent_.back(), k);
  ++sequence_;
}

void GvspDevice::send_packet(const Image& image, std::uint32_t k) {
  std::vector<std::uint8_t> packet(image.chunk + 64, 0);
  std::size_t size = 44;
  put16(&packet[2], image.id);
  put32(&packet[4], (k == 0 ? 1U : k == image.last ? 2U : 3U) << 24 | k);
  if (k == 0) {
    put16(&packet[10], 1);
    put32(&packet[12], image.time_ns >> 32);
    put32(&packet[16], image.time_ns);
    put32(&packet[20], image.format);
    put32(&packet[24], image.width);
    put32(&packet[28], image.height);
  } else if (k == image.last) {
    put32(&packet[8], 1);
    put32(&packet[12], image.height);
    size = 16;
  } else {
    const std::size_t offset = (k - 1) * image.chunk;
    const std::size_t count = std::min(image.chunk, image.bytes.size() - offset);
    std::memcpy(&packet[8], &image.bytes[offset], count);
    size = count + 8;
  }
  packet.resize(size);
  std::uniform_real_distribution<double> chance(0, 1);
  const auto emit = [&](const std::vector<std::uint8_t>& p) {
    sendto(stream_, p.data(), p.size(), 0, reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_);
  };
  if (chance(random_) < faults_.loss) return;
  if (held_.empty() && chance(random_) < faults_.reordering) {
    held_ = std::move(packet);
    return;
  }
  emit(packet);
  if (chance(random_) < faults_.duplicates) emit(packet);
  if (!held_.empty()) emit(held_);
  held_.clear();
}

}  // namespace rptv
