// SPDX-License-Identifier: MIT
// An Aravis source with its intake, and a book of what came.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "acquisition/aravis_source.hpp"
#include "acquisition/intake.hpp"
#include "core/clock.hpp"
#include "tests/acquisition/camera_lives.hpp"
#include "tests/acquisition/gvsp_image.hpp"
#include "tests/acquisition/payload.hpp"

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
  ClockId clock = ClockId::nominal;  ///< of the newest
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
  /// Counted as lost, without what is only estimated.
  std::uint64_t lost() const { return intake_.losses(0).total() - estimated(); }
  std::uint64_t estimated() const { return intake_.losses(0).of(LossCause::source_outage); }
  /// Images of which it is known what became of them.
  std::uint64_t accounted() const { return received_.images + lost(); }
  /// What the camera sent in its lives so far; the test tells when one is over.
  CameraLives& lives() { return lives_; }
  /// True once every image that was sent is accounted for. The camera must send no more.
  bool settles_at(std::uint64_t sent) {
    return take_until([&] { return accounted() >= sent; }) && accounted() == sent;
  }
  DeviceStatus status(std::size_t camera = 0) const { return source_.device_status().at(camera); }

 private:
  void look(const Frame& frame) {
    const std::vector<std::uint8_t> sent = payload_of(frame, format_);
    const std::uint64_t number = sequence_of(sent.data(), sent.size());
    received_.wrong += number <= received_.newest || frame.info.index <= received_.newest_index;
    if (received_.images++ == 0) {
      received_.first = number;
      received_.first_index = frame.info.index;
    }
    received_.newest = number;
    lives_.came(number);
    received_.newest_index = frame.info.index;
    received_.clock = frame.info.clock;
  }

  const std::string format_;
  AravisSource source_;
  Intake intake_;
  Received received_;
  CameraLives lives_;
};

}  // namespace rptv
