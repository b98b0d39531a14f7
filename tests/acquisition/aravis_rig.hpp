// SPDX-License-Identifier: MIT
// An Aravis source with its intake, and a book of what came.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "acquisition/aravis_source.hpp"
#include "acquisition/intake.hpp"
#include "acquisition/pixel_format.hpp"
#include "tests/acquisition/gvsp_device.hpp"

namespace rptv {

inline constexpr std::int64_t kPatience_ns = 60'000'000'000;

inline AravisSettings settings_for(const std::string& address) {
  AravisSettings settings;
  settings.cameras = {address};
  settings.region = {0, 0, 128, 96};
  settings.rate_hz = 100;
  settings.packet_size = 1400;
  return settings;
}

/// What came: numbers of the images, and how many were not what the camera had sent.
struct Received {
  std::uint64_t images = 0, wrong = 0, first = 0, newest = 0, first_index = 0, newest_index = 0;
};

class Rig {
 public:
  explicit Rig(const AravisSettings& settings)
      : format_(settings.pixel_format), source_(settings, 16), intake_(source_.cameras(), {Bounded{8}, 16, 4}) {
    source_.start(intake_);
  }
  ~Rig() {
    intake_.close();
    source_.stop();
  }

  /// Takes images until `enough`; false when that did not come in time.
  bool take_until(const std::function<bool()>& enough) {
    const std::int64_t deadline_ns = host_now_ns() + kPatience_ns;
    FrameSet set;
    while (!enough() && host_now_ns() < deadline_ns)
      if (intake_.next(set, 50'000'000) == Taken::value) look(set.frames[0]);
    return enough();
  }
  const Received& received() const { return received_; }
  std::uint64_t lost() const { return intake_.losses(0).total(); }
  DeviceStatus status(std::size_t camera = 0) const { return source_.device_status().at(camera); }

 private:
  void look(const Frame& frame) {
    const std::vector<std::uint8_t> sent = as_sent(frame);
    const std::uint64_t number = sequence_of(sent.data(), sent.size());
    received_.wrong += number <= received_.newest || frame.info.index <= received_.newest_index;
    if (received_.images++ == 0) {
      received_.first = number;
      received_.first_index = frame.info.index;
    }
    received_.newest = number;
    received_.newest_index = frame.info.index;
  }
  /// The payload that makes this image.
  std::vector<std::uint8_t> as_sent(const Frame& frame) const {
    const std::uint8_t* bytes = frame.view().as_u8();
    if (find_pixel_format(format_)->unpack == nullptr) return {bytes, bytes + frame.shape.bytes()};
    const std::uint16_t* pixels = frame.view().as_u16();
    const std::size_t count = frame.shape.bytes() / 2;
    std::vector<std::uint8_t> sent;
    if (format_ == "Mono12Packed") {
      for (std::size_t i = 0; i < count; i += 2)
        for (const int byte : {pixels[i] >> 4, (pixels[i] & 15) | (pixels[i + 1] & 15) << 4, pixels[i + 1] >> 4})
          sent.push_back(static_cast<std::uint8_t>(byte));
      return sent;
    }
    std::uint32_t bits = 0, held = 0;  // a stream, lowest bit first
    for (std::size_t i = 0; i < count; ++i) {
      bits |= std::uint32_t{pixels[i]} << held;
      for (held += find_pixel_format(format_)->payload_bits; held >= 8; held -= 8, bits >>= 8)
        sent.push_back(static_cast<std::uint8_t>(bits));
    }
    return sent;
  }

  const std::string format_;
  AravisSource source_;
  Intake intake_;
  Received received_;
};

}  // namespace rptv
