// SPDX-License-Identifier: MIT
// Images out of the driver and its buffers back, one at a time.
#include "acquisition/v4l2_device.hpp"

#include <linux/videodev2.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace rptv {

V4l2Device::~V4l2Device() { close(); }

int V4l2Device::call(unsigned long request, void* argument) noexcept {
  const int result = system_.call(descriptor_, request, argument);
  if (result < 0) errno_ = errno;
  return result;
}

v4l2_buffer V4l2Device::any_buffer(std::uint32_t number) const noexcept {
  v4l2_buffer buffer{};
  buffer.index = number;
  buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  buffer.memory = lent_ ? V4L2_MEMORY_USERPTR : V4L2_MEMORY_MMAP;
  if (lent_) {
    buffer.m.userptr = reinterpret_cast<unsigned long>(loan_.memory(number));
    buffer.length = static_cast<std::uint32_t>(shape_.bytes());
  }
  return buffer;
}

V4l2Device::Took V4l2Device::take(V4l2Image& image, int wake, int timeout_ms) noexcept {
  pollfd waited[2] = {{descriptor_, POLLIN | POLLPRI, 0}, {wake, POLLIN, 0}};
  const int ready = system_.poll(waited, 2, timeout_ms);
  if (ready < 0 && errno != EINTR && errno != EAGAIN) {
    errno_ = errno;
    return Took::lost;
  }
  if (ready <= 0 || waited[0].revents == 0) return Took::nothing;
  if ((waited[0].revents & POLLPRI) != 0) {
    v4l2_event event{};
    if (call(VIDIOC_DQEVENT, &event) == 0 && event.type == V4L2_EVENT_SOURCE_CHANGE) return Took::changed;
  }
  v4l2_buffer buffer = any_buffer(0);
  if (call(VIDIOC_DQBUF, &buffer) < 0) {
    const bool failed = (waited[0].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    return errno_ == EAGAIN && !failed ? Took::nothing : Took::lost;
  }
  const bool ours = lent_ ? loan_.memory(buffer.index) != nullptr : buffer.index < mappings_.size();
  if (!ours) {
    errno_ = EPROTO;
    return Took::lost;
  }
  const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  image.buffer = buffer.index;
  image.sequence = buffer.sequence;
  image.time_ns = std::int64_t{buffer.timestamp.tv_sec} * 1'000'000'000 + std::int64_t{buffer.timestamp.tv_usec} * 1000;
  image.clock = monotonic ? ClockId::host_monotonic : ClockId::device;
  image.torn = (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0U || buffer.bytesused < needed_;
  return Took::image;
}

FrameLease V4l2Device::exchange(V4l2Image& image, FrameLease other) noexcept {
  if (lent_) {
    FrameLease full = loan_.take(image.buffer);
    image.buffer = loan_.put(std::move(other));
    return full;
  }
  const auto* row = static_cast<const std::byte*>(mappings_[image.buffer].memory);
  std::byte* to = other.get();
  for (std::uint32_t y = 0; y < shape_.height_px; ++y, row += stride_, to += shape_.row_bytes())
    if (format_.unpack != nullptr)
      format_.unpack(row, to, shape_.width_px);
    else
      std::memcpy(to, row, shape_.row_bytes());
  return other;
}

bool V4l2Device::give_back(const V4l2Image& image) noexcept {
  v4l2_buffer buffer = any_buffer(image.buffer);
  return call(VIDIOC_QBUF, &buffer) == 0;
}

std::string V4l2Device::link() const {
  const bool monotonic = (flags_ & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  const bool begin = (flags_ & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  return std::string(format_.name) + " " + std::to_string(shape_.width_px) + " x " + std::to_string(shape_.height_px) +
         " px, " + std::to_string(lent_ ? loan_.lent() : mappings_.size()) + " buffers, " +
         (lent_ ? "userptr" : "mmap") + ", stamps of " + (monotonic ? "CLOCK_MONOTONIC" : "the device's clock") +
         (begin ? " at the start of exposure" : " at the end of the image");
}

}  // namespace rptv
