// SPDX-License-Identifier: MIT
// The memory that a V4L2 driver fills: slots of the sink that are lent to it, or buffers of its own.
#include "acquisition/v4l2_device.hpp"

#include <linux/videodev2.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstring>

#include "core/error.hpp"

namespace rptv {

void V4l2Device::start(FrameSink& sink) {
  if (memory_ != "mmap") lent_ = lend(sink);
  if (!lent_ && memory_ == "userptr")
    throw Error(ExitCode::unavailable, path_ + ": does not write straight into frame slots, v4l2.memory = 'userptr' (" +
                                           std::strerror(errno_) + "); set it to 'auto'");
  if (!lent_) map();
  int input = 0;
  call(VIDIOC_G_INPUT, &input);
  v4l2_event_subscription change{};
  change.type = V4L2_EVENT_SOURCE_CHANGE;
  change.id = static_cast<std::uint32_t>(input);
  call(VIDIOC_SUBSCRIBE_EVENT, &change);  // few devices have it; without it, nothing changes either
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  demand(VIDIOC_STREAMON, &type, "does not start", "USB: too little bandwidth? Use another port or a smaller image");
  streaming_ = true;
}

/// How many the driver gives; 0 when it refuses. `count` 0 frees them.
std::uint32_t V4l2Device::request_buffers(std::size_t count) noexcept {
  v4l2_requestbuffers request{};
  request.count = static_cast<std::uint32_t>(count);
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = lent_ ? V4L2_MEMORY_USERPTR : V4L2_MEMORY_MMAP;
  return call(VIDIOC_REQBUFS, &request) == 0 ? request.count : 0;
}

/// False, with all undone, when the driver cannot: the image must lie in its buffer as it does in a slot.
bool V4l2Device::lend(FrameSink& sink) noexcept {
  const bool same = format_.unpack == nullptr && format_.only_luma && stride_ == shape_.row_bytes();
  if (!same || image_size_ > shape_.bytes()) {
    errno_ = EOPNOTSUPP;
    return false;
  }
  errno_ = ENOBUFS;  // unless a call says otherwise
  lent_ = true;
  const std::uint32_t least = request_buffers(1);  // the driver raises it to what it needs to run
  bool done = least > 0 && least <= loan_.lent();
  if (done) {
    const std::uint32_t numbers = request_buffers(V4l2Loan::kMostBuffers);
    done = numbers >= loan_.lent() && loan_.claim(sink, numbers);
  }
  for (std::uint32_t i = 0; done && i < loan_.lent(); ++i) {
    v4l2_buffer buffer = any_buffer(i);
    if (i == 0) {
      v4l2_buffer first = buffer;
      if (call(VIDIOC_QUERYBUF, &first) == 0) flags_ = first.flags;
    }
    done = call(VIDIOC_QBUF, &buffer) == 0;
  }
  if (!done) {
    const int why = errno_;
    request_buffers(0);
    loan_.end();
    errno_ = why;
  }
  lent_ = false;
  return done;
}

void V4l2Device::map() {
  const std::uint32_t count = request_buffers(static_cast<std::size_t>(buffers_));
  if (count == 0)
    throw Error(ExitCode::unavailable,
                path_ + ": gives no buffers (" + std::strerror(errno_) + "); close the program that uses the camera");
  for (std::uint32_t i = 0; i < count; ++i) {
    v4l2_buffer buffer = any_buffer(i);
    demand(VIDIOC_QUERYBUF, &buffer, "does not tell of its buffers", "set v4l2.buffers lower");
    void* memory = system_.mmap(descriptor_, buffer.length, static_cast<long>(buffer.m.offset));
    if (memory == MAP_FAILED)
      throw Error(ExitCode::unavailable, path_ + ": buffers cannot be mapped; set v4l2.buffers lower");
    mappings_.push_back({memory, buffer.length});
    if (buffer.length < needed_)
      throw Error(ExitCode::unavailable, path_ + ": has buffers smaller than its images; update its driver");
    flags_ = buffer.flags;
    demand(VIDIOC_QBUF, &buffer, "refuses its own buffer", "unplug the camera and plug it in again");
  }
}

void V4l2Device::close() noexcept {
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  if (streaming_) call(VIDIOC_STREAMOFF, &type);
  streaming_ = false;
  for (const Mapping& mapping : mappings_) system_.munmap(mapping.memory, mapping.bytes);
  mappings_.clear();
  if (descriptor_ >= 0) system_.close(descriptor_);  // from here on the driver writes into no slot
  descriptor_ = -1;
}

}  // namespace rptv
