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
#include "tests/acquisition/gvsp_truth.hpp"

namespace rptv {

struct GvspFaults {
  double loss = 0, duplicates = 0, reordering = 0;  ///< per packet
  bool answers_resend = true;
  std::uint16_t first_id = 1;
  std::uint32_t seed = 1;
  double strays = 0;  ///< per image: a packet before it that belongs to no image
  bool ptp_has_master = true;
  std::uint64_t lost_at_start = 0;  ///< images of which no packet leaves
};

struct GvspIdentity {
  std::string serial = "SIM1";
  std::uint64_t last_sequence = 0;  ///< image numbers begin after it
};

/// Runs from construction to destruction on a thread of its own, at GVCP's port of `address` (any of 127.x.y.z).
class GvspDevice {
 public:
  /// Throws std::runtime_error when the port is taken. Keeps its truth in `truth`, or in itself.
  GvspDevice(std::string address, GvspFaults faults, GvspIdentity identity = {}, GvspTruth* truth = nullptr);
  ~GvspDevice();
  /// Sends the image under way to its end, and from then on only answers. Returns when that is so.
  void rest();
  const GvspTruth& truth() const { return truth_; }

 private:
  struct Image {
    std::uint16_t id = 0;
    std::uint32_t width = 0, height = 0, format = 0, last = 0;
    std::uint64_t time_ns = 0;
    std::size_t per_packet = 0;
    bool has_chunks = false;
    std::vector<std::uint8_t> bytes;
  };
  void run();
  void answer(int descriptor);
  bool obey(std::uint16_t command, const std::uint8_t* request, std::size_t size, std::uint8_t* reply,
            std::size_t& length);
  void write(std::uint32_t address, std::uint32_t value);
  void resend(const std::uint8_t* request);
  void follow_master();
  bool is_for_us(const std::uint8_t* action);
  void send_image();
  void add_chunks(Image& image);
  void send_stray(std::uint16_t id);
  void send(const std::vector<std::uint8_t>& packet);
  void send_packet(const Image& image, std::uint32_t packet);
  std::uint32_t reg(std::uint32_t address);

  const GvspFaults faults_;
  GvspTruth own_truth_;
  GvspTruth& truth_;
  ArvFakeCamera* registers_;
  int control_ = -1, stream_ = -1, discovery_ = -1;
  std::mt19937 random_;
  sockaddr_in peer_{};
  std::deque<Image> recent_;
  std::vector<std::uint8_t> held_;
  std::uint16_t next_id_;
  const std::uint64_t last_sequence_;
  std::atomic<bool> stop_{false}, rest_{false}, rests_{false};
  Wake rested_;
  std::uint64_t pulled_ = 0;  // triggers, not yet answered with an image
  std::thread thread_;
};

}  // namespace rptv
