// SPDX-License-Identifier: MIT
// Set-up calls on the virtual card, and the loop that takes frames from a source on it.
#include "tests/acquisition/vivid_card.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <thread>

#include "acquisition/v4l2_controls.hpp"
#include "core/descriptor.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kLong_ns = 30'000'000'000;  // emulated, on a loaded machine

/// That the capture node takes its images from.
void choose_input(int number) {
  V4l2System system;
  const Descriptor card(system.open(kCapture));
  ASSERT_EQ(system.call(card.get(), VIDIOC_S_INPUT, &number), 0);
}

void use_first_timings(const char* node) {
  V4l2System system;
  const Descriptor card(system.open(node));
  v4l2_enum_dv_timings first{};
  ASSERT_EQ(system.call(card.get(), VIDIOC_ENUM_DV_TIMINGS, &first), 0);
  ASSERT_EQ(system.call(card.get(), VIDIOC_S_DV_TIMINGS, &first.timings), 0);
}

}  // namespace

void press(const std::string& control, const std::string& node) {
  V4l2System system;
  const Descriptor card(system.open(node.c_str()));
  ASSERT_TRUE(card.open()) << node;
  EXPECT_TRUE(set_v4l2_controls(system, card.get(), node, {control}).empty()) << control;
}

HdmiInput::HdmiInput() {
  choose_input(1);
  use_first_timings(kCapture);
  use_first_timings(kOutput);
  press("osd_text_mode=none", kCapture);
}

HdmiInput::~HdmiInput() { choose_input(0); }

V4l2Settings webcam(const std::string& pixel_format) {
  V4l2Settings settings;
  settings.devices = {kCapture};
  settings.pixel_format = pixel_format;
  settings.width_px = 320, settings.height_px = 180;
  settings.rate_hz = 60;
  settings.buffers = 4;
  return settings;
}

VividSession::VividSession(const V4l2Settings& settings)
    : source_(settings, kPoolFrames), intake_(source_.cameras(), {Bounded{16}, kPoolFrames, 4}) {
  indices_.reserve(1000);  // tests count allocations
  source_.start(intake_);
}

VividSession::~VividSession() { stop(); }

void VividSession::stop() {
  intake_.close();
  source_.stop();
  FrameSet set;
  while (intake_.next(set, 0) == Taken::value) indices_.push_back(set.info().index);
}

FrameSet VividSession::next() {
  FrameSet set;
  EXPECT_EQ(intake_.next(set, kLong_ns), Taken::value) << status().problem;
  if (set.cameras > 0) indices_.push_back(set.info().index);
  return set;
}

bool VividSession::take_until(const std::function<bool()>& enough) {
  const std::int64_t deadline_ns = host_now_ns() + kLong_ns;
  while (!enough())
    if (host_now_ns() > deadline_ns || next().cameras == 0) return false;
  return true;
}

bool VividSession::take(std::size_t frames) {
  return take_until([this, until = indices_.size() + frames] { return indices_.size() >= until; });
}

bool VividSession::wait_for(const std::function<bool()>& enough) {
  const std::int64_t deadline_ns = host_now_ns() + kLong_ns;
  while (!enough()) {
    if (host_now_ns() > deadline_ns) return false;
    std::this_thread::yield();
  }
  return true;
}

std::uint64_t VividSession::counter(const std::string& name) const {
  for (const DeviceCounter& counter : status().counters)
    if (counter.name == name) return counter.count;
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

}  // namespace rptv
