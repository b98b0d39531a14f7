// SPDX-License-Identifier: MIT
// Our own images, played into the virtual card's HDMI output and taken from its HDMI input: every byte is compared.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <sys/mman.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <set>
#include <thread>

#include "core/descriptor.hpp"
#include "tests/acquisition/vivid_card.hpp"

namespace rptv {
namespace {

constexpr std::uint32_t kWidth = 640, kHeight = 480;  // of the card's first timings
constexpr std::uint32_t kImages = 4;                  // then they begin again

/// Grey value of pixel `i` of image `number`; of pixel 0 it is the number.
std::uint32_t grey_value(std::uint32_t number, std::uint32_t i, std::uint32_t bits) {
  return (number + i * (i / kWidth + 40503)) & ((1U << bits) - 1);
}

struct Format {
  const char* name;
  std::uint32_t fourcc, bits;
  const char* memory;
  const char* used = memory;
};

/// As the camera of this format would send it; without colour, as it is to be in its slot.
std::vector<std::uint8_t> image(const Format& format, std::uint32_t number, bool colour) {
  std::vector<std::uint8_t> bytes;
  for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
    const std::uint32_t grey = grey_value(number, i, format.bits);
    bytes.push_back(static_cast<std::uint8_t>(grey));
    if (colour) bytes.push_back(static_cast<std::uint8_t>(i * 3));
    if (format.bits > 8) bytes.push_back(static_cast<std::uint8_t>(grey >> 8));
  }
  return bytes;
}

/// Plays images 0 … kImages − 1 over and over on a thread of its own.
class Player {
 public:
  explicit Player(const Format& format) : node_(system_.open(kOutput)) {
    for (std::uint32_t number = 0; number < kImages; ++number)
      images_.push_back(image(format, number, format.fourcc == V4L2_PIX_FMT_YUYV));
    v4l2_format set{};
    set.type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    set.fmt.pix.width = kWidth, set.fmt.pix.height = kHeight;
    set.fmt.pix.pixelformat = format.fourcc;
    call(VIDIOC_S_FMT, &set);
    EXPECT_EQ(set.fmt.pix.sizeimage, images_.front().size());
    v4l2_requestbuffers request{};
    request.count = 3, request.type = V4L2_BUF_TYPE_VIDEO_OUTPUT, request.memory = V4L2_MEMORY_MMAP;
    call(VIDIOC_REQBUFS, &request);
    for (std::uint32_t i = 0; i < request.count; ++i) {
      v4l2_buffer buffer = some_buffer();
      buffer.index = i;
      call(VIDIOC_QUERYBUF, &buffer);
      memory_.push_back(::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, node_.get(),
                               static_cast<off_t>(buffer.m.offset)));
      bytes_ = buffer.length;
      play_in(buffer);
    }
    int type = V4L2_BUF_TYPE_VIDEO_OUTPUT;
    call(VIDIOC_STREAMON, &type);
    thread_ = std::thread([this] { play(); });
  }
  ~Player() {
    stopping_ = true;
    thread_.join();
    for (void* memory : memory_) ::munmap(memory, bytes_);
  }

 private:
  static v4l2_buffer some_buffer() {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_OUTPUT, buffer.memory = V4L2_MEMORY_MMAP;
    return buffer;
  }
  void call(unsigned long request, void* argument) {
    EXPECT_EQ(system_.call(node_.get(), request, argument), 0) << std::strerror(errno);
  }
  void play_in(v4l2_buffer& buffer) {
    const std::vector<std::uint8_t>& bytes = images_[number_++ % kImages];
    std::memcpy(memory_[buffer.index], bytes.data(), bytes.size());
    buffer.bytesused = static_cast<std::uint32_t>(bytes.size());
    buffer.field = V4L2_FIELD_NONE;
    call(VIDIOC_QBUF, &buffer);
  }
  void play() {
    while (!stopping_) {
      pollfd played{node_.get(), POLLOUT, 0};
      if (system_.poll(&played, 1, 100) <= 0) continue;
      v4l2_buffer buffer = some_buffer();
      call(VIDIOC_DQBUF, &buffer);
      play_in(buffer);
    }
  }

  V4l2System system_;
  std::vector<std::vector<std::uint8_t>> images_;
  Descriptor node_;
  std::vector<void*> memory_;
  std::size_t bytes_ = 0;
  std::uint32_t number_ = 0;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

class V4l2VividImages : public testing::TestWithParam<Format> {
 protected:
  V4l2VividImages() { press("loop_video=1", kCapture); }
  ~V4l2VividImages() override { press("loop_video=0", kCapture); }
  const HdmiInput input_;
};

TEST_P(V4l2VividImages, come_through_exactly) {
  const Format& format = GetParam();
  const Player player(format);
  std::vector<std::vector<std::uint8_t>> expected;
  for (std::uint32_t number = 0; number < kImages; ++number) expected.push_back(image(format, number, false));
  const auto is_exact = [&expected](const ImageView& view) {
    const std::uint32_t number = grey_at(view, 0);
    return number < kImages && view.shape.bytes() == expected[number].size() &&
           std::memcmp(view.data, expected[number].data(), view.shape.bytes()) == 0;
  };
  V4l2Settings settings = webcam(format.name);
  settings.memory = format.memory;
  settings.width_px = kWidth, settings.height_px = kHeight, settings.rate_hz = 0;
  VividSession session(settings);
  EXPECT_THAT(session.status().link, testing::HasSubstr(std::string(" buffers, ") + format.used + ","));
  // Until the first of our images is through, the card sends noise.
  bool through = false;
  for (int i = 0; i < 100 && !through; ++i) {
    const FrameSet set = session.next();
    ASSERT_EQ(set.cameras, 1U);
    through = is_exact(set.frames[0].view());
  }
  ASSERT_TRUE(through);
  // The two clocks are apart: some images come twice, others not at all.
  std::set<std::uint32_t> numbers;
  for (int i = 0; i < 500 && (i < 10 || numbers.size() < kImages); ++i) {
    const FrameSet set = session.next();
    ASSERT_EQ(set.cameras, 1U);
    EXPECT_TRUE(is_exact(set.frames[0].view())) << i;
    numbers.insert(grey_at(set.frames[0].view(), 0));
  }
  EXPECT_EQ(numbers.size(), kImages);
}

INSTANTIATE_TEST_SUITE_P(Formats, V4l2VividImages,
                         testing::Values(Format{"GREY", V4L2_PIX_FMT_GREY, 8, "mmap"},
                                         Format{"GREY", V4L2_PIX_FMT_GREY, 8, "userptr"},
                                         Format{"Y10", V4L2_PIX_FMT_Y10, 10, "mmap"},
                                         Format{"Y10", V4L2_PIX_FMT_Y10, 10, "userptr"},
                                         Format{"Y12", V4L2_PIX_FMT_Y12, 12, "auto", "userptr"},
                                         Format{"Y16", V4L2_PIX_FMT_Y16, 16, "auto", "userptr"},
                                         Format{"YUYV", V4L2_PIX_FMT_YUYV, 8, "auto", "mmap"}),
                         [](const auto& format) { return format.param.name + std::string("_") + format.param.memory; });

}  // namespace
}  // namespace rptv
