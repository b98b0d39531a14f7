// SPDX-License-Identifier: MIT
// A small GigE Vision camera for tests: Aravis' fake camera gives registers and XML, our sockets speak GVCP and GVSP.
#pragma once

#include <arpa/inet.h>
#include <arv.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.hpp"
#include "core/wake.hpp"

namespace rptv {

struct GvspFaults {
  double loss = 0, duplicates = 0, reordering = 0;  ///< per packet
  bool answers_resend = true;
  std::uint16_t first_id = 1;
  std::uint32_t seed = 1;
};

/// Image `sequence`: the number itself in the first 8 bytes, then words made from it.
void fill_image(std::uint8_t* image, std::size_t bytes, std::uint64_t sequence);
/// The number, or 0 when any byte is wrong (numbers begin at 1).
std::uint64_t sequence_of(const std::uint8_t* image, std::size_t bytes);

/// Runs from construction to destruction on a thread of its own, at GVCP's port of `address` (any of 127.x.y.z).
class GvspDevice {
 public:
  /// Throws std::runtime_error when the port is taken. Image numbers begin after `last_sequence`.
  GvspDevice(std::string address, GvspFaults faults, std::uint64_t last_sequence = 0);
  ~GvspDevice();
  /// Falls silent, as by a loss of power. Idempotent.
  void stop();
  /// Neither answers nor sends for so long, then goes on where it was.
  void hang(std::int64_t ms);
  std::uint64_t sent() const { return sequence_.load(); }  ///< number of the newest image
  std::uint64_t resent() const { return resent_.load(); }

 private:
  struct Image {
    std::uint16_t id = 0;
    std::uint32_t width = 0, height = 0, format = 0, last = 0;
    std::uint64_t time_ns = 0;
    std::size_t chunk = 0;
    std::vector<std::uint8_t> bytes;
  };
  void run();
  void hang_if_told();
  void answer();
  bool obey(std::uint16_t command, const std::uint8_t* request, std::size_t size, std::uint8_t* reply,
            std::size_t& length);
  void resend(const std::uint8_t* request);
  void send_image();
  void send_packet(const Image& image, std::uint32_t packet);
  std::uint32_t reg(std::uint32_t address);

  const GvspFaults faults_;
  ArvFakeCamera* registers_;
  int control_ = -1, stream_ = -1;
  std::mt19937 random_;
  sockaddr_in peer_{};
  std::deque<Image> recent_;
  std::vector<std::uint8_t> held_;
  std::uint16_t next_id_;
  std::atomic<std::uint64_t> sequence_, resent_{0};
  std::atomic<bool> stop_{false};
  Wake stopped_;
  std::atomic<std::int64_t> hangs_until_ns_{0};
  std::thread thread_;
};

}  // namespace rptv
