// SPDX-License-Identifier: MIT
// The kernel's virtual video card (vivid) as the emulated machine has it, its faults, and a V4l2Source on it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "acquisition/intake.hpp"
#include "acquisition/v4l2_source.hpp"

namespace rptv {

inline constexpr const char* kCapture = "/dev/video0";  // inputs: 0 webcam, 1 HDMI
inline constexpr const char* kOutput = "/dev/video1";   // HDMI, loops to input 1

/// Sets a control of the card, for instance a fault: "disconnect=1". Through the output node, which stays free.
void press(const std::string& control, const std::string& node = kOutput);

/// While it lives, the card takes its images from the HDMI input, 640 x 480 px at 60 Hz.
struct HdmiInput {
  HdmiInput();
  ~HdmiInput();
};

inline std::uint32_t grey_at(const ImageView& view, std::size_t i) {
  return view.shape.bytes_per_pixel == 2 ? view.as_u16()[i] : view.as_u8()[i];
}

V4l2Settings webcam(const std::string& pixel_format = "GREY");

/// A running source. Waits are bounded; a test that gets nothing fails.
class VividSession {
 public:
  static constexpr std::size_t kPoolFrames = 24;

  explicit VividSession(const V4l2Settings& settings);
  ~VividSession();

  /// The next frame of the camera; an empty set after a failure.
  FrameSet next();
  /// Takes frames until `enough`; false when that does not come.
  bool take_until(const std::function<bool()>& enough);
  bool take(std::size_t frames);
  /// Takes no frames meanwhile.
  static bool wait_for(const std::function<bool()>& enough);
  /// Frames that are still on their way count as taken.
  void stop();

  DeviceStatus status() const { return source_.device_status().front(); }
  std::uint64_t counter(const std::string& name) const;
  std::uint64_t lost(LossCause cause) const { return intake_.losses(0).of(cause); }
  std::size_t free_slots() const { return intake_.free_slots(0); }
  /// Of the frames that take…() saw.
  const std::vector<std::uint64_t>& indices() const noexcept { return indices_; }

 private:
  V4l2Source source_;
  Intake intake_;
  std::vector<std::uint64_t> indices_;
};

}  // namespace rptv
