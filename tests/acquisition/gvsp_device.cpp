// SPDX-License-Identifier: MIT
// Life and images of the test camera: GVSP packets, with seeded faults.
#include "tests/acquisition/gvsp_device.hpp"

#include <poll.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "tests/acquisition/gvsp_image.hpp"
#include "tests/acquisition/gvsp_registers.hpp"
#include "tests/acquisition/gvsp_wire.hpp"

namespace rptv {

GvspDevice::GvspDevice(std::string address, GvspFaults faults, GvspIdentity identity, GvspTruth* truth)
    : faults_(faults),
      truth_(truth != nullptr ? *truth : own_truth_),
      registers_(make_gvsp_registers(identity.serial)),
      control_(bound_socket(address, kGvcpPort)),
      stream_(bound_socket(address, 0)),
      // Broadcasts to all of loopback, where several cameras listen.
      discovery_(bound_socket("127.255.255.255", kGvcpPort, true)),
      random_(faults.seed),
      next_id_(faults.first_id),
      last_sequence_(identity.last_sequence) {
  GInetAddress* inet = g_inet_address_new_from_string(address.c_str());
  arv_fake_camera_set_inet_address(registers_, inet);
  g_object_unref(inet);
  thread_ = std::thread([this] { run(); });
}

void GvspDevice::rest() {
  rest_ = true;
  for (std::uint32_t seen = rested_.prepare(); !rests_; seen = rested_.prepare()) rested_.wait(seen, 1'000'000'000);
}

GvspDevice::~GvspDevice() {
  stop_ = true;
  thread_.join();
  for (const int descriptor : {control_, stream_, discovery_}) close(descriptor);
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
    if (rest_ && !rests_.exchange(true)) rested_.notify();
    for (; pulled_ > 0; --pulled_) send_image();
    const bool acquires =
        !rests_ && reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION) != 0 && reg(ARV_FAKE_CAMERA_REGISTER_TRIGGER_MODE) == 0;
    follow_master();
    const std::int64_t now_ns = host_now_ns();
    if (!acquires) due_ns = now_ns;
    const std::int64_t rest_ns = acquires ? std::clamp<std::int64_t>(due_ns - now_ns, 0, 20'000'000) : 20'000'000;
    pollfd waiting[]{{control_, POLLIN, 0}, {discovery_, POLLIN, 0}};
    const timespec rest{0, rest_ns};
    if (ppoll(waiting, 2, &rest, nullptr) > 0)
      for (const int descriptor : {control_, discovery_}) answer(descriptor);
    if (!acquires || host_now_ns() < due_ns) continue;
    send_image();
    due_ns += std::int64_t{1000} * reg(ARV_FAKE_CAMERA_REGISTER_ACQUISITION_FRAME_PERIOD_US);
    due_ns = std::max(due_ns, host_now_ns() - 50'000'000);
  }
}

// One state further at each latch: disabled, listening, slave.
void GvspDevice::follow_master() {
  if (reg(kPtpEnable) == 0 || reg(kPtpLatch) == 0) return;
  const std::uint32_t state = reg(kPtpStatus), last = faults_.ptp_has_master ? 2 : 1;
  arv_fake_camera_write_register(registers_, kPtpStatus, std::min(state + 1, last));
  arv_fake_camera_write_register(registers_, kPtpOffset, static_cast<std::uint32_t>(-120));
  arv_fake_camera_write_register(registers_, kPtpLatch, 0);
}

void GvspDevice::send_image() {
  Image image;
  image.id = next_id_;
  next_id_ = static_cast<std::uint16_t>(next_id_ == 0xffff ? 1 : next_id_ + 1);
  image.width = reg(ARV_FAKE_CAMERA_REGISTER_WIDTH);
  image.height = reg(ARV_FAKE_CAMERA_REGISTER_HEIGHT);
  image.format = reg(ARV_FAKE_CAMERA_REGISTER_PIXEL_FORMAT);
  image.time_ns = static_cast<std::uint64_t>(host_now_ns());
  image.per_packet = (reg(0x0d04) & 0xffffU) - 36;  // IP 20, UDP 8, GVSP 8
  image.bytes.resize(std::size_t{image.width} * image.height * (image.format >> 16 & 0xffU) / 8);
  fill_image(image.bytes.data(), image.bytes.size(), last_sequence_ + ++truth_.begun);
  if (reg(kChunkMode) != 0) add_chunks(image);
  image.last = static_cast<std::uint32_t>((image.bytes.size() + image.per_packet - 1) / image.per_packet + 1);
  peer_.sin_family = AF_INET;
  peer_.sin_port = htons(static_cast<std::uint16_t>(reg(0x0d00) & 0xffffU));
  peer_.sin_addr.s_addr = htonl(reg(0x0d18));
  if (recent_.size() >= 16) recent_.pop_front();
  recent_.push_back(std::move(image));
  send_stray(recent_.back().id);
  if (truth_.begun > faults_.lost_at_start)
    for (std::uint32_t k = 0; k <= recent_.back().last; ++k) send_packet(recent_.back(), k);
  ++truth_.sent;
}

// Of the number of the image and a constant exposure.
void GvspDevice::add_chunks(Image& image) {
  const auto end_chunk = [&](std::uint32_t id, std::size_t bytes) {
    image.bytes.resize(image.bytes.size() + 8);
    put32(&image.bytes[image.bytes.size() - 8], id);
    put32(&image.bytes[image.bytes.size() - 4], bytes);
  };
  const auto add = [&](std::uint32_t chunk, std::uint64_t word) {
    if (reg(kChunkEnable + 4 * chunk) == 0) return;
    image.bytes.resize(image.bytes.size() + 8);
    put32(&image.bytes[image.bytes.size() - 8], word >> 32);
    put32(&image.bytes[image.bytes.size() - 4], word);
    end_chunk(kChunkIds + chunk, 8);
  };
  end_chunk(1, image.bytes.size());
  add(kFrameIdChunk, last_sequence_ + truth_.begun);
  add(kExposureChunk, std::bit_cast<std::uint64_t>(kExposureInChunk_us));
  image.has_chunks = true;
}

// Content type 5 is compressed video, which no camera here sends.
void GvspDevice::send_stray(std::uint16_t id) {
  if (std::uniform_real_distribution<double>(0, 1)(random_) >= faults_.strays) return;
  std::vector<std::uint8_t> packet(16, 0);
  put16(&packet[2], id);
  put32(&packet[4], 5U << 24);
  send(packet);
}

void GvspDevice::send(const std::vector<std::uint8_t>& packet) {
  sendto(stream_, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&peer_), sizeof peer_);
}

void GvspDevice::send_packet(const Image& image, std::uint32_t k) {
  std::vector<std::uint8_t> packet(image.per_packet + 64, 0);
  std::size_t size = 44;
  put16(&packet[2], image.id);
  put32(&packet[4], (k == 0 ? 1U : k == image.last ? 2U : 3U) << 24 | k);
  if (k == 0) {
    put16(&packet[10], image.has_chunks ? 0x4001 : 1);
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
    const std::size_t offset = (k - 1) * image.per_packet;
    const std::size_t count = std::min(image.per_packet, image.bytes.size() - offset);
    std::memcpy(&packet[8], &image.bytes[offset], count);
    size = count + 8;
  }
  packet.resize(size);
  std::uniform_real_distribution<double> chance(0, 1);
  if (chance(random_) < faults_.loss) return;
  if (held_.empty() && chance(random_) < faults_.reordering) {
    held_ = std::move(packet);
    return;
  }
  send(packet);
  if (chance(random_) < faults_.duplicates) send(packet);
  if (!held_.empty()) send(held_);
  held_.clear();
}

}  // namespace rptv
