// SPDX-License-Identifier: MIT
// The kernel's V4L2 calls in their order, and what comes back compared with what was asked.
#include "acquisition/v4l2_device.hpp"

#include <linux/videodev2.h>
#include <sys/mman.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "acquisition/unpack.hpp"
#include "acquisition/v4l2_controls.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr v4l2_buf_type kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;

struct Format {
  const char* name;
  std::uint32_t fourcc;
  std::uint32_t bits;
  std::size_t (*row_bytes)(std::size_t pixels) noexcept;
};
constexpr Format kFormats[] = {
    {"GREY", V4L2_PIX_FMT_GREY, 8, [](std::size_t n) noexcept { return n; }},
    {"Y10", V4L2_PIX_FMT_Y10, 10, [](std::size_t n) noexcept { return 2 * n; }},
    {"Y12", V4L2_PIX_FMT_Y12, 12, [](std::size_t n) noexcept { return 2 * n; }},
    {"Y16", V4L2_PIX_FMT_Y16, 16, [](std::size_t n) noexcept { return 2 * n; }},
    {"Y10P", V4L2_PIX_FMT_Y10P, 10, bytes_of_mipi10},
    {"Y12P", v4l2_fourcc('Y', '1', '2', 'P'), 12, bytes_of_mipi12},  // newer than Debian 12's headers
    {"YUYV", V4L2_PIX_FMT_YUYV, 8, [](std::size_t n) noexcept { return 2 * n; }},
    {"NV12", V4L2_PIX_FMT_NV12, 8, [](std::size_t n) noexcept { return n; }},
};

const Format& format_of(const std::string& name) {
  for (const Format& format : kFormats)
    if (name == format.name) return format;
  throw Error(ExitCode::configuration, "v4l2.pixel_format = '" + name + "' is not known; use GREY, Y10, Y12 or Y16");
}

v4l2_buffer any_buffer() noexcept {
  v4l2_buffer buffer{};
  buffer.type = kCapture;
  buffer.memory = V4L2_MEMORY_MMAP;
  return buffer;
}

}  // namespace

V4l2Device::V4l2Device(V4l2System& system, const std::string& path, const V4l2Settings& settings)
    : system_(system), path_(path), buffers_(settings.buffers), descriptor_(system.open(path.c_str())) {
  if (descriptor_ < 0) {
    const bool denied = errno == EACCES || errno == EPERM;
    throw Error(denied ? ExitCode::permission : ExitCode::unavailable,
                path + ": " + std::strerror(errno) +
                    (denied ? "; join the group 'video'" : "; plug the camera in, or mend v4l2.devices"));
  }
  try {
    v4l2_capability capability{};
    demand(VIDIOC_QUERYCAP, &capability, "is no V4L2 device", "name a video node in v4l2.devices");
    const std::uint32_t can =
        (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0U ? capability.device_caps : capability.capabilities;
    if ((can & V4L2_CAP_VIDEO_CAPTURE) == 0U || (can & V4L2_CAP_STREAMING) == 0U)
      throw Error(ExitCode::unavailable, path + ": does not stream images; name its capture node in v4l2.devices");
    name_ = reinterpret_cast<const char*>(capability.card) + std::string(" (") +
            reinterpret_cast<const char*>(capability.bus_info) + ", " + path + ")";
    set_format(settings);
    set_rate(settings.rate_hz);
    set_controls(settings.controls);
  } catch (...) {
    close();
    throw;
  }
}

V4l2Device::~V4l2Device() { close(); }

int V4l2Device::call(unsigned long request, void* argument) noexcept {
  const int result = system_.call(descriptor_, request, argument);
  if (result < 0) errno_ = errno;
  return result;
}

void V4l2Device::demand(unsigned long request, void* argument, const char* what, const char* next) {
  if (call(request, argument) < 0)
    throw Error(ExitCode::unavailable, path_ + ": " + what + " (" + std::strerror(errno_) + "); " + next);
}

void V4l2Device::set_format(const V4l2Settings& settings) {
  const Format& format = format_of(settings.pixel_format);
  v4l2_format set{};
  set.type = kCapture;
  demand(VIDIOC_G_FMT, &set, "does not tell its format", "another capture node may");
  v4l2_pix_format& pixels = set.fmt.pix;
  if (settings.width_px != 0) pixels.width = static_cast<std::uint32_t>(settings.width_px);
  if (settings.height_px != 0) pixels.height = static_cast<std::uint32_t>(settings.height_px);
  pixels.pixelformat = format.fourcc;
  pixels.field = V4L2_FIELD_NONE;
  pixels.bytesperline = pixels.sizeimage = 0;  // else the stride of the format before stays
  const std::uint32_t width = pixels.width, height = pixels.height;
  demand(VIDIOC_S_FMT, &set, "refuses its format", "close the program that uses the camera");
  if (pixels.pixelformat != format.fourcc)
    throw Error(ExitCode::configuration, path_ + ": does not give v4l2.pixel_format = '" + settings.pixel_format +
                                             "'; see `v4l2-ctl --list-formats-ext`");
  if (pixels.width != width || pixels.height != height)
    throw Error(ExitCode::configuration, path_ + ": gives " + std::to_string(pixels.width) + " x " +
                                             std::to_string(pixels.height) + " px where " + std::to_string(width) +
                                             " x " + std::to_string(height) +
                                             " was asked; set v4l2.width_px and height_px to a size that it has");
  bits_ = format.bits;
  fourcc_ = format.fourcc;
  shape_ = {width, height, format.bits > 8 ? 2U : 1U};
  const std::size_t row = format.row_bytes(width);
  stride_ = pixels.bytesperline == 0 ? row : pixels.bytesperline;
  if (stride_ < row || width == 0 || height == 0)
    throw Error(ExitCode::unavailable, path_ + ": states rows of " + std::to_string(stride_) + " bytes, which " +
                                           std::to_string(width) + " px do not fit; update its driver");
  needed_ = stride_ * (height - 1) + row;
}

void V4l2Device::set_rate(double rate_hz) {
  v4l2_streamparm rate{};
  rate.type = kCapture;
  v4l2_fract& frame = rate.parm.capture.timeperframe;
  const bool adjustable =
      call(VIDIOC_G_PARM, &rate) == 0 && (rate.parm.capture.capability & V4L2_CAP_TIMEPERFRAME) != 0U;
  if (rate_hz > 0 && adjustable) {
    frame = {1'000'000, static_cast<std::uint32_t>(std::lround(rate_hz * 1e6 > 4e9 ? 4e9 : rate_hz * 1e6))};
    if (rate_hz > 4000) frame = {1000, static_cast<std::uint32_t>(std::lround(rate_hz * 1000))};
    demand(VIDIOC_S_PARM, &rate, "refuses v4l2.rate_hz", "set it to 0 and see what the driver gives");
  }
  if (adjustable && frame.denominator != 0) period_ns_ = 1'000'000'000LL * frame.numerator / frame.denominator;
  const double got_hz = period_ns_ > 0 ? 1e9 / static_cast<double>(period_ns_) : 0;
  if (rate_hz > 0 && std::abs(got_hz - rate_hz) > 0.01 * rate_hz)
    throw Error(ExitCode::configuration, path_ + ": gives " + std::to_string(got_hz) + " Hz where v4l2.rate_hz = " +
                                             std::to_string(rate_hz) + "; set a rate that it has, or 0");
}

void V4l2Device::set_controls(const std::vector<std::string>& wishes) {
  for (const std::string& line : set_v4l2_controls(system_, descriptor_, path_, wishes))
    otherwise_ += (otherwise_.empty() ? path_ + ": " : ", ") + line;
  if (!otherwise_.empty()) otherwise_ += "; mend v4l2.controls";
}

void V4l2Device::start() {
  v4l2_requestbuffers request{};
  request.count = static_cast<std::uint32_t>(buffers_);
  request.type = kCapture;
  request.memory = V4L2_MEMORY_MMAP;
  demand(VIDIOC_REQBUFS, &request, "gives no buffers", "close the program that uses the camera");
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = any_buffer();
    buffer.index = i;
    demand(VIDIOC_QUERYBUF, &buffer, "does not tell of its buffers", "set v4l2.buffers lower");
    void* memory = system_.mmap(descriptor_, buffer.length, static_cast<long>(buffer.m.offset));
    if (memory == MAP_FAILED)
      throw Error(ExitCode::unavailable, path_ + ": buffers cannot be mapped; set v4l2.buffers lower");
    mappings_.push_back({memory, buffer.length});
    if (buffer.length < needed_)
      throw Error(ExitCode::unavailable, path_ + ": has buffers smaller than its images; update its driver");
    demand(VIDIOC_QBUF, &buffer, "refuses its own buffer", "unplug the camera and plug it in again");
  }
  v4l2_event_subscription change{};
  change.type = V4L2_EVENT_SOURCE_CHANGE;
  call(VIDIOC_SUBSCRIBE_EVENT, &change);  // few devices have it; without it, nothing changes either
  int type = kCapture;
  demand(VIDIOC_STREAMON, &type, "does not start", "USB: too little bandwidth? Use another port or a smaller image");
  streaming_ = true;
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
    if (call(VIDIOC_DQEVENT, &event) == 0 && event.type == V4L2_EVENT_SOURCE_CHANGE) {
      errno_ = EPIPE;
      return Took::lost;
    }
  }
  v4l2_buffer buffer = any_buffer();
  if (call(VIDIOC_DQBUF, &buffer) < 0) {
    const bool failed = (waited[0].revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
    return errno_ == EAGAIN && !failed ? Took::nothing : Took::lost;
  }
  if (buffer.index >= mappings_.size()) {
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

void V4l2Device::copy(const V4l2Image& image, std::byte* to) const noexcept {
  const auto* row = static_cast<const std::byte*>(mappings_[image.buffer].memory);
  for (std::uint32_t y = 0; y < shape_.height_px; ++y, row += stride_, to += shape_.row_bytes()) {
    if (fourcc_ == V4L2_PIX_FMT_YUYV)
      extract_yuyv_luma(row, reinterpret_cast<std::uint8_t*>(to), shape_.width_px);
    else if (fourcc_ == V4L2_PIX_FMT_Y10P)
      unpack_mipi10(row, reinterpret_cast<std::uint16_t*>(to), shape_.width_px);
    else if (fourcc_ == v4l2_fourcc('Y', '1', '2', 'P'))
      unpack_mipi12(row, reinterpret_cast<std::uint16_t*>(to), shape_.width_px);
    else
      std::memcpy(to, row, shape_.row_bytes());
  }
}

bool V4l2Device::give_back(const V4l2Image& image) noexcept {
  v4l2_buffer buffer = any_buffer();
  buffer.index = image.buffer;
  return call(VIDIOC_QBUF, &buffer) == 0;
}

void V4l2Device::close() noexcept {
  int type = kCapture;
  if (streaming_) call(VIDIOC_STREAMOFF, &type);
  streaming_ = false;
  for (const Mapping& mapping : mappings_) system_.munmap(mapping.memory, mapping.bytes);
  mappings_.clear();
  if (descriptor_ >= 0) system_.close(descriptor_);
  descriptor_ = -1;
}

}  // namespace rptv
