// SPDX-License-Identifier: MIT
// What a V4L2 device is told before it streams, and what it makes of that compared with what was asked.
#include "acquisition/v4l2_device.hpp"

#include <linux/videodev2.h>

#include <cerrno>
#include <cmath>
#include <cstring>

#include "acquisition/v4l2_controls.hpp"
#include "acquisition/v4l2_modes.hpp"
#include "core/error.hpp"

namespace rptv {
namespace {

constexpr v4l2_buf_type kCapture = V4L2_BUF_TYPE_VIDEO_CAPTURE;

}  // namespace

V4l2Device::V4l2Device(V4l2System& system, const std::string& path, const V4l2Settings& settings, V4l2Loan& loan)
    : system_(system),
      path_(path),
      format_(find_v4l2_format(settings.pixel_format)),
      memory_(settings.memory),
      buffers_(settings.buffers),
      loan_(loan),
      descriptor_(system.open(path.c_str())) {
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
    set_timings();
    set_format(settings);
    set_rate(settings.rate_hz);
    set_controls(settings.controls);
  } catch (...) {
    close();
    throw;
  }
}

void V4l2Device::demand(unsigned long request, void* argument, const char* what, const char* next) {
  if (call(request, argument) < 0)
    throw Error(ExitCode::unavailable, path_ + ": " + what + " (" + std::strerror(errno_) + "); " + next);
}

/// Only inputs for video signals (HDMI, SDI) have timings: those of the signal are taken over.
void V4l2Device::set_timings() {
  v4l2_dv_timings timings{};
  const bool told = call(VIDIOC_QUERY_DV_TIMINGS, &timings) == 0;
  // Busy: another program streams; the format that it set is compared below.
  if (told && (call(VIDIOC_S_DV_TIMINGS, &timings) == 0 || errno_ == EBUSY)) return;
  if (told || errno_ == ERANGE)
    throw Error(ExitCode::unavailable, path_ + ": has a signal that it cannot take; set its source to another mode");
  if (errno_ == ENOLINK || errno_ == ENOLCK)
    throw Error(ExitCode::unavailable, path_ + ": has no stable signal at its input; connect and switch on its source");
}

void V4l2Device::set_format(const V4l2Settings& settings) {
  v4l2_format set{};
  set.type = kCapture;
  demand(VIDIOC_G_FMT, &set, "does not tell its format", "another capture node may");
  v4l2_pix_format& pixels = set.fmt.pix;
  if (settings.width_px != 0) pixels.width = static_cast<std::uint32_t>(settings.width_px);
  if (settings.height_px != 0) pixels.height = static_cast<std::uint32_t>(settings.height_px);
  pixels.pixelformat = format_.fourcc;
  pixels.field = V4L2_FIELD_NONE;
  pixels.bytesperline = pixels.sizeimage = 0;  // else the stride of the format before stays
  const std::uint32_t width = pixels.width, height = pixels.height;
  demand(VIDIOC_S_FMT, &set, "refuses its format", "close the program that uses the camera");
  if (pixels.pixelformat != format_.fourcc)
    throw Error(ExitCode::configuration, path_ + ": does not give v4l2.pixel_format = '" + settings.pixel_format +
                                             "'; see `v4l2-ctl --list-formats-ext`");
  if (pixels.field != V4L2_FIELD_NONE)
    throw Error(ExitCode::configuration, path_ + ": gives interlaced images; set its source to a progressive mode");
  if (pixels.width != width || pixels.height != height) {
    const std::string sizes = v4l2_sizes(system_, descriptor_, format_.fourcc);
    throw Error(ExitCode::configuration, path_ + ": gives " + std::to_string(pixels.width) + " x " +
                                             std::to_string(pixels.height) + " px where " + std::to_string(width) +
                                             " x " + std::to_string(height) +
                                             " was asked; set v4l2.width_px and height_px to a size that it has" +
                                             (sizes.empty() ? "" : ": " + sizes));
  }
  shape_ = {width, height, format_.significant_bits > 8 ? 2U : 1U};
  const std::size_t row = format_.row_bytes(width);
  stride_ = pixels.bytesperline == 0 ? row : pixels.bytesperline;
  if (stride_ < row || width == 0 || height == 0)
    throw Error(ExitCode::unavailable, path_ + ": states rows of " + std::to_string(stride_) + " bytes, which " +
                                           std::to_string(width) + " px do not fit; update its driver");
  needed_ = stride_ * (height - 1) + row;
  image_size_ = pixels.sizeimage;
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
  if (rate_hz == 0 || std::abs(got_hz - rate_hz) <= 0.01 * rate_hz) return;
  const std::string rates = v4l2_rates(system_, descriptor_, format_.fourcc, shape_.width_px, shape_.height_px);
  throw Error(ExitCode::configuration, path_ + ": gives " + std::to_string(got_hz) +
                                           " Hz where v4l2.rate_hz = " + std::to_string(rate_hz) +
                                           "; set a rate that it has, or 0" + (rates.empty() ? "" : ": " + rates));
}

void V4l2Device::set_controls(const std::vector<std::string>& wishes) {
  for (const std::string& line : set_v4l2_controls(system_, descriptor_, path_, wishes))
    otherwise_ += (otherwise_.empty() ? path_ + ": " : ", ") + line;
  if (!otherwise_.empty()) otherwise_ += "; mend v4l2.controls";
}

}  // namespace rptv
