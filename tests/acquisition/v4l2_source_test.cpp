// SPDX-License-Identifier: MIT
// V4L2 cameras over a driver of ours that drops, tears, wraps its counter and goes away: every frame is accounted for.
#include "acquisition/v4l2_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <deque>

#include "acquisition/intake.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kLongNs = 20'000'000'000;

struct Shot {
  std::uint32_t sequence;
  bool torn = false;
  int error = 0;  // of DQBUF, instead of an image
  int time_ms = 0;
};

// Plays its shots, one a poll, then nothing until it is woken. 8 x 1 pixels, each the low byte of the sequence. As the
// kernel does, it fills the buffers in the order that they were queued in.
class Driver : public V4l2System {
 public:
  explicit Driver(std::vector<Shot> shots, int refused_openings = 0, unsigned rate_hz = 0)
      : shots_(std::move(shots)), refusals_(refused_openings), rate_hz_(rate_hz) {}
  int open(const char*) noexcept override {
    if (opened_++ > 0 && refusals_-- > 0) return errno = ENOENT, -1;
    return 77;
  }
  int close(int) noexcept override { return queued_.clear(), 0; }
  void* mmap(int, std::size_t, long) noexcept override { return memory_; }
  int munmap(void*, std::size_t) noexcept override { return 0; }
  int poll(pollfd* descriptors, unsigned long count, int timeout_ms) noexcept override {
    if (descriptors[0].fd != 77) return V4l2System::poll(descriptors, count, 1);  // between two openings
    if (next_ == shots_.size()) return V4l2System::poll(descriptors + 1, 1, timeout_ms);
    descriptors[0].revents = POLLIN;
    return 1;
  }
  int ioctl(int, unsigned long request, void* argument) noexcept override {
    if (request == VIDIOC_QUERYCAP)
      static_cast<v4l2_capability*>(argument)->capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    if (request == VIDIOC_G_FMT || request == VIDIOC_S_FMT) {
      v4l2_pix_format& pixels = static_cast<v4l2_format*>(argument)->fmt.pix;
      pixels.width = 8, pixels.height = 1, pixels.bytesperline = 8;
    }
    if (request == VIDIOC_G_PARM && rate_hz_ > 0) {
      v4l2_captureparm& capture = static_cast<v4l2_streamparm*>(argument)->parm.capture;
      capture.capability = V4L2_CAP_TIMEPERFRAME;
      capture.timeperframe = {1, rate_hz_};
    }
    if (request == VIDIOC_REQBUFS && static_cast<v4l2_requestbuffers*>(argument)->memory == refused_memory)
      return errno = EINVAL, -1;
    if (request == VIDIOC_STREAMON && starts-- <= 0) return errno = ENOSPC, -1;
    if (request == VIDIOC_QBUF) queued_.push_back(*static_cast<v4l2_buffer*>(argument));
    if (request == VIDIOC_QUERYBUF) static_cast<v4l2_buffer*>(argument)->length = sizeof memory_;
    if (request == VIDIOC_DQBUF) {
      const Shot& shot = shots_[next_++];
      if (shot.error != 0) return errno = shot.error, -1;
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      if (queued_.empty()) return errno = EIO, -1;
      const bool user = queued_.front().memory == V4L2_MEMORY_USERPTR;
      auto* pixels = user ? reinterpret_cast<std::uint8_t*>(queued_.front().m.userptr) : memory_;
      buffer.index = queued_.front().index, buffer.bytesused = 8, buffer.sequence = shot.sequence;
      queued_.pop_front();
      buffer.timestamp.tv_usec = shot.time_ms * 1000;
      buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | (shot.torn ? V4L2_BUF_FLAG_ERROR : 0U);
      std::fill_n(pixels, 8, static_cast<std::uint8_t>(shot.sequence));
    }
    return 0;
  }
  std::uint32_t refused_memory = 0;
  int starts = 99;  // then it refuses to stream

 private:
  const std::vector<Shot> shots_;
  std::deque<v4l2_buffer> queued_;
  int refusals_;
  const unsigned rate_hz_;
  std::size_t next_ = 0;
  int opened_ = 0;
  std::uint8_t memory_[8] = {};
};

V4l2Settings one_camera(const std::string& memory = "auto") {
  V4l2Settings settings;
  settings.memory = memory;
  settings.devices = {"/dev/video9"};
  return settings;
}

struct Outcome {
  std::vector<std::uint64_t> indices;
  std::vector<int> pixels;
  std::uint64_t gaps = 0, outage = 0, torn = 0, duplicates = 0;
  DeviceStatus status;
};

// Until `frames` sets came.
Outcome play(Driver& driver, std::size_t frames, const std::string& memory = "auto") {
  Outcome outcome;
  V4l2Source source(one_camera(memory), 64, &driver);
  Intake intake(source.cameras(), {Bounded{64}, 64, 4});
  source.start(intake);
  while (outcome.indices.size() < frames) {
    FrameSet set;
    if (intake.next(set, kLongNs) != Taken::value) break;
    outcome.indices.push_back(set.info().index);
    outcome.pixels.push_back(set.frames[0].view().as_u8()[7]);
  }
  outcome.status = source.device_status().front();
  source.stop();
  outcome.gaps = intake.losses(0).of(LossCause::source_gap);
  outcome.outage = intake.losses(0).of(LossCause::source_outage);
  outcome.torn = intake.losses(0).of(LossCause::source_torn);
  outcome.duplicates = intake.losses(0).of(LossCause::source_duplicate);
  return outcome;
}

std::uint64_t count_of(const DeviceStatus& status, const std::string& name) {
  for (const DeviceCounter& counter : status.counters)
    if (counter.name == name) return counter.count;
  ADD_FAILURE() << "no counter " << name;
  return 0;
}

class V4l2SourceMemory : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Memory, V4l2SourceMemory, testing::Values("userptr", "mmap"),
                         [](const auto& memory) { return std::string(memory.param); });

TEST_P(V4l2SourceMemory, delivers_or_counts_every_frame_of_the_driver) {
  Driver driver({{7}, {8}, {11}, {12, true}, {12}, {13}});
  const Outcome outcome = play(driver, 4, GetParam());
  EXPECT_THAT(outcome.status.link, testing::HasSubstr(GetParam()));
  EXPECT_THAT(outcome.indices, testing::ElementsAre(7, 8, 11, 13));
  EXPECT_THAT(outcome.pixels, testing::ElementsAre(7, 8, 11, 13));
  EXPECT_EQ(outcome.gaps, 2U);
  EXPECT_EQ(outcome.torn, 1U);
  EXPECT_EQ(outcome.duplicates, 1U);
  EXPECT_EQ(count_of(outcome.status, "dequeued"), 6U);
  EXPECT_EQ(count_of(outcome.status, "sequence_gaps"), 2U);
}

TEST(V4l2Source, goes_on_over_the_wrap_of_the_counter) {
  Driver driver({{UINT32_MAX - 1}, {UINT32_MAX}, {0}, {2}});
  const Outcome outcome = play(driver, 4);
  EXPECT_THAT(outcome.indices, testing::ElementsAre(4294967294U, 4294967295U, 4294967296U, 4294967298U));
  EXPECT_EQ(outcome.gaps, 1U);
}

TEST_P(V4l2SourceMemory, comes_back_with_larger_indices_after_the_device_was_gone) {
  for (const int error : {ENODEV, EIO}) {
    Driver driver({{100}, {101}, {0, false, error}, {0}, {1}}, 3);
    const Outcome outcome = play(driver, 4, GetParam());
    EXPECT_THAT(outcome.indices, testing::ElementsAre(100, 101, 102, 103));
    EXPECT_THAT(outcome.pixels, testing::ElementsAre(100, 101, 0, 1));
    EXPECT_EQ(outcome.status.sessions, 2U);
    EXPECT_EQ(outcome.status.state, DeviceState::streaming);
    EXPECT_EQ(count_of(outcome.status, "device_lost"), 1U);
  }
}

TEST(V4l2Source, counts_what_a_device_will_have_missed_while_it_was_gone) {
  Driver driver({{100, false, 0, 10}, {101, false, 0, 30}, {0, false, ENODEV}, {0, false, 0, 230}}, 2, 50);
  const Outcome outcome = play(driver, 3);
  EXPECT_THAT(outcome.indices, testing::ElementsAre(100, 101, 111));
  EXPECT_EQ(outcome.outage, 9U);
  EXPECT_EQ(outcome.gaps, 0U);
  EXPECT_EQ(outcome.status.last_outage, (Outage{1, 111, 200'000'000, 9}));
}

TEST(V4l2Source, copies_where_the_driver_takes_no_slots) {
  Driver driver(std::vector<Shot>{{1}, {2}});
  driver.refused_memory = V4L2_MEMORY_USERPTR;
  const Outcome outcome = play(driver, 2);
  EXPECT_THAT(outcome.pixels, testing::ElementsAre(1, 2));
  EXPECT_THAT(outcome.status.link, testing::HasSubstr("8 buffers, mmap"));
  Driver strict({});
  strict.refused_memory = V4L2_MEMORY_USERPTR;
  EXPECT_THAT([&] { play(strict, 0, "userptr"); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("set it to 'auto'")));
}

TEST(V4l2Source, leaves_frames_alone_that_are_still_in_use) {
  std::vector<Shot> shots;
  for (std::uint32_t i = 0; i < 300; ++i) shots.push_back({i});
  Driver driver(shots);
  V4l2Source source(one_camera("userptr"), 64, &driver);  // more slots than the driver has numbers for
  Intake intake(source.cameras(), {Lossless{4}, 64, 4});
  source.start(intake);
  std::deque<FrameSet> held;
  for (std::uint64_t i = 0; i < 300; ++i) {
    held.emplace_back();
    ASSERT_EQ(intake.next(held.back(), kLongNs), Taken::value);
    ASSERT_EQ(held.back().info().index, i);
    for (const FrameSet& set : held) ASSERT_EQ(set.frames[0].view().as_u8()[0], set.info().index % 256);
    if (held.size() > 30 + i % 15) held.erase(held.begin() + static_cast<std::ptrdiff_t>(i % held.size()));
  }
  intake.close();
  source.stop();
}

TEST(V4l2Source, gives_every_slot_back) {
  Driver driver(std::vector<Shot>{{1}, {2}, {3}});
  V4l2Source source(one_camera("userptr"), 6, &driver);
  Intake intake(source.cameras(), {Bounded{6}, 6, 4});
  source.start(intake);
  FrameSet set;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(intake.next(set, kLongNs), Taken::value);
  EXPECT_EQ(intake.free_slots(0), 2U);  // half of the six lie with the driver, one is here
  source.stop();
  set.reset();
  EXPECT_EQ(intake.free_slots(0), 6U);
}

TEST(V4l2Source, leaves_no_slot_with_a_driver_when_another_camera_does_not_start) {
  Driver driver({});
  driver.starts = 1;
  V4l2Settings settings = one_camera("userptr");
  settings.devices.push_back("/dev/video10");
  V4l2Source source(settings, 16, &driver);
  Intake intake(source.cameras(), {Newest{}, 16, 4});
  EXPECT_THROW(source.start(intake), Error);
  EXPECT_EQ(intake.free_slots(0) + intake.free_slots(1), 32U);
}

TEST(V4l2Source, stops_while_a_driver_fills_nothing) {
  Driver driver({});
  EXPECT_EQ(play(driver, 0).status.state, DeviceState::streaming);
}

TEST(V4l2Source, asks_for_devices_and_names_one_that_is_not_there) {
  EXPECT_THROW(V4l2Source(V4l2Settings{}, 16), Error);
  V4l2Settings settings = one_camera();
  settings.devices = {"/dev/no-such-camera"};
  const auto open = [&] { V4l2Source(settings, 16); };
  EXPECT_THAT(open, testing::Throws<Error>(testing::Property(&Error::code, ExitCode::unavailable)));
  EXPECT_THAT(open,
              testing::ThrowsMessage<Error>(testing::HasSubstr("/dev/no-such-camera: No such file or directory")));
}

}  // namespace
}  // namespace rptv
