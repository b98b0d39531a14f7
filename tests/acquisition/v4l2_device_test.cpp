// SPDX-License-Identifier: MIT
// A V4L2 device over a driver of ours that answers its system calls, well and badly.
#include "acquisition/v4l2_device.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>
#include <tuple>

#include "acquisition/intake.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

using testing::HasSubstr;
using Took = V4l2Device::Took;

// 4 x 2 pixels in rows of 16 bytes; buffer 0 over and over.
class Driver : public V4l2System {
 public:
  int open(const char*) noexcept override { return ++opened, fails(0) ? -1 : 77; }
  int close(int) noexcept override { return ++closed, 0; }
  int munmap(void*, std::size_t) noexcept override { return --mapped, 0; }
  void* mmap(int, std::size_t, long) noexcept override { return ++mapped, memory; }
  int poll(pollfd* descriptors, unsigned long, int) noexcept override {
    descriptors[0].revents = events;
    return events != 0 ? 1 : 0;
  }
  int ioctl(int, unsigned long request, void* argument) noexcept override {
    if (interruptions > 0) return --interruptions, errno = EINTR, -1;
    if (fails(request)) return -1;
    if (request == VIDIOC_QUERYCAP)
      static_cast<v4l2_capability*>(argument)->capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
    if (request == VIDIOC_G_FMT || request == VIDIOC_S_FMT) {
      v4l2_pix_format& pixels = static_cast<v4l2_format*>(argument)->fmt.pix;
      stale_stride |= request == VIDIOC_S_FMT && pixels.bytesperline != 0;
      pixels.width = 4, pixels.height = 2, pixels.bytesperline = 16, pixels.sizeimage = 32;
      if (field != V4L2_FIELD_ANY) pixels.field = field;
    }
    if (request == VIDIOC_QUERYBUF) static_cast<v4l2_buffer*>(argument)->length = length;
    if (request == VIDIOC_DQBUF) {
      auto& buffer = *static_cast<v4l2_buffer*>(argument);
      buffer.index = 0, buffer.bytesused = bytesused, buffer.sequence = sequence++;
      buffer.flags = flags, buffer.timestamp = {12, 34};
    }
    return 0;
  }
  bool fails(unsigned long request) noexcept {
    if (request != failing || error == 0) return false;
    errno = error;
    return true;
  }
  unsigned long failing = 0;
  int error = 0, interruptions = 0, opened = 0, closed = 0, mapped = 0;
  bool stale_stride = false;
  std::uint32_t field = V4L2_FIELD_ANY;  // what it makes of every field
  short events = POLLIN;
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC, bytesused = 32, length = 32, sequence = 5;
  std::uint8_t memory[32] = {};
};

V4l2Settings grey() { return {}; }

struct Sink {
  Intake intake{{{"/dev/video9", {4, 2, 1}, 8}}, {Newest{}, 8, 4}};
  V4l2Loan loan{0, 4};
};

/// Streaming.
struct Started : Sink {
  explicit Started(Driver& driver) : device(driver, "/dev/video9", grey(), loan) { device.start(intake); }
  V4l2Device device;
};

std::string refusal(Driver& driver, const V4l2Settings& settings) {
  Sink sink;
  try {
    V4l2Device device(driver, "/dev/video9", settings, sink.loan);
    device.start(sink.intake);
  } catch (const Error& error) {
    EXPECT_EQ(driver.closed, driver.opened - (driver.failing == 0 && driver.error != 0 ? 1 : 0));
    EXPECT_EQ(driver.mapped, 0);
    return error.what();
  }
  return "accepted";
}

TEST(V4l2Device, leaves_the_padding_of_rows_out) {
  Driver driver;
  for (std::uint8_t i = 0; i < 32; ++i) driver.memory[i] = i;
  Started started(driver);
  V4l2Device& device = started.device;
  V4l2Image image;
  ASSERT_EQ(device.take(image, -1, 0), Took::image);
  const FrameLease out = device.exchange(image, started.intake.claim(0));
  const auto* pixels = reinterpret_cast<const std::uint8_t*>(out.get());
  EXPECT_THAT(std::vector<int>(pixels, pixels + 8), testing::ElementsAre(0, 1, 2, 3, 16, 17, 18, 19));
  EXPECT_EQ(image.sequence, 5U);
  EXPECT_EQ(image.time_ns, 12'000'034'000);
  EXPECT_EQ(image.clock, ClockId::host_monotonic);
  EXPECT_FALSE(image.torn);
  EXPECT_FALSE(driver.stale_stride);
}

TEST(V4l2Device, refuses_a_size_that_the_driver_changed) {
  Driver driver;
  V4l2Settings settings = grey();
  settings.width_px = 5;
  EXPECT_THAT(refusal(driver, settings), HasSubstr("gives 4 x 2 px where 5 x 2 was asked"));
}

TEST(V4l2Device, refuses_interlaced_images) {
  Driver driver;
  driver.field = V4L2_FIELD_ALTERNATE;
  EXPECT_THAT(refusal(driver, grey()), HasSubstr("gives interlaced images"));
}

TEST(V4l2Device, takes_no_signal_with_timings_that_the_driver_refuses) {
  const std::tuple<unsigned long, int, const char*> cases[] = {
      {VIDIOC_QUERY_DV_TIMINGS, ENOTTY, "accepted"},
      {VIDIOC_QUERY_DV_TIMINGS, ENOLINK, "has no stable signal at its input"},
      {VIDIOC_QUERY_DV_TIMINGS, ERANGE, "has a signal that it cannot take"},
      {VIDIOC_S_DV_TIMINGS, EINVAL, "has a signal that it cannot take"},
      {VIDIOC_S_DV_TIMINGS, EBUSY, "accepted"}};
  for (const auto& [request, error, words] : cases) {
    Driver driver;
    driver.failing = request, driver.error = error;
    EXPECT_THAT(refusal(driver, grey()), HasSubstr(words)) << error;
  }
}

TEST(V4l2Device, says_what_failed_and_leaves_nothing_open) {
  for (const unsigned long request :
       {VIDIOC_QUERYCAP, VIDIOC_S_FMT, VIDIOC_REQBUFS, VIDIOC_QUERYBUF, VIDIOC_QBUF, VIDIOC_STREAMON}) {
    Driver driver;
    driver.failing = request, driver.error = EBUSY;
    EXPECT_THAT(refusal(driver, grey()), HasSubstr("/dev/video9: ")) << request;
  }
  Driver denied;
  denied.error = EACCES;
  EXPECT_THAT(refusal(denied, grey()), HasSubstr("join the group 'video'"));
  Driver small;
  small.length = 16;
  EXPECT_THAT(refusal(small, grey()), HasSubstr("smaller than its images"));
}

TEST(V4l2Device, goes_on_after_interruptions) {
  Driver driver;
  driver.interruptions = 1000;
  Started started(driver);
  V4l2Device& device = started.device;
  driver.interruptions = 1000;
  V4l2Image image;
  EXPECT_EQ(device.take(image, -1, 0), Took::image);
  EXPECT_TRUE(device.give_back(image));
}

TEST(V4l2Device, calls_flagged_and_short_images_torn) {
  Driver driver;
  Started started(driver);
  V4l2Device& device = started.device;
  V4l2Image image;
  driver.flags |= V4L2_BUF_FLAG_ERROR;
  ASSERT_EQ(device.take(image, -1, 0), Took::image);
  EXPECT_TRUE(image.torn);
  driver.flags = 0, driver.bytesused = 19;
  ASSERT_EQ(device.take(image, -1, 0), Took::image);
  EXPECT_TRUE(image.torn);
  EXPECT_EQ(image.clock, ClockId::device);
  driver.bytesused = 20;  // the padding of the last row may be missing
  ASSERT_EQ(device.take(image, -1, 0), Took::image);
  EXPECT_FALSE(image.torn);
}

TEST(V4l2Device, tells_a_busy_driver_from_a_lost_one) {
  Driver driver;
  Started started(driver);
  V4l2Device& device = started.device;
  V4l2Image image;
  driver.failing = VIDIOC_DQBUF, driver.error = EAGAIN;
  EXPECT_EQ(device.take(image, -1, 0), Took::nothing);
  driver.events = POLLERR;
  EXPECT_EQ(device.take(image, -1, 0), Took::lost);
  for (const int error : {EIO, ENODEV}) {
    driver.events = POLLIN, driver.error = error;
    EXPECT_EQ(device.take(image, -1, 0), Took::lost);
    EXPECT_EQ(device.last_errno(), error);
  }
  driver.events = 0;
  EXPECT_EQ(device.take(image, -1, 0), Took::nothing);
}

}  // namespace
}  // namespace rptv
