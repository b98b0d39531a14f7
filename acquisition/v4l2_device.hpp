// SPDX-License-Identifier: MIT
// One open V4L2 capture device: set up, streaming, and its buffers one at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/v4l2_settings.hpp"
#include "acquisition/v4l2_system.hpp"
#include "core/clock.hpp"
#include "core/image.hpp"

namespace rptv {

/// A filled buffer of the driver.
struct V4l2Image {
  std::uint32_t buffer = 0;    ///< for give_back()
  std::uint32_t sequence = 0;  ///< the driver's frame counter, 32 bit, wraps
  std::int64_t time_ns = 0;    ///< the driver's stamp
  ClockId clock = ClockId::device;
  bool torn = false;  ///< the driver's error flag, or fewer bytes than the image needs
};

/// One thread at a time. Set-up throws Error(unavailable, permission, configuration), after which nothing is left open.
class V4l2Device {
 public:
  enum class Took : std::uint8_t { image, nothing, lost };

  V4l2Device(V4l2System& system, const std::string& path, const V4l2Settings& settings);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  const ImageShape& shape() const noexcept { return shape_; }
  std::uint32_t significant_bits() const noexcept { return bits_; }
  std::int64_t period_ns() const noexcept { return period_ns_; }  ///< 0: the driver does not say
  const std::string& name() const noexcept { return name_; }
  /// What the driver made of the controls otherwise than asked, with the next step; empty: nothing.
  const std::string& otherwise() const noexcept { return otherwise_; }

  /// Maps the buffers and begins to stream.
  void start();
  /// Waits until a buffer is filled, `wake` becomes readable or the time is over. `lost`: the device is gone, failed or
  /// changed its format; last_errno() says why. No exception, no allocation.
  Took take(V4l2Image& image, int wake, int timeout_ms) noexcept;
  /// Unpacks the image into contiguous rows of shape().
  void copy(const V4l2Image& image, std::byte* to) const noexcept;
  /// False when the driver refuses the buffer: the device is as good as lost.
  bool give_back(const V4l2Image& image) noexcept;
  int last_errno() const noexcept { return errno_; }

 private:
  struct Mapping {
    void* memory;
    std::size_t bytes;
  };
  int call(unsigned long request, void* argument) noexcept;
  void demand(unsigned long request, void* argument, const char* what, const char* next);
  void set_format(const V4l2Settings& settings);
  void set_rate(double rate_hz);
  void set_controls(const std::vector<std::string>& wishes);
  void close() noexcept;

  V4l2System& system_;
  const std::string path_;
  const std::int64_t buffers_;
  int descriptor_ = -1;
  std::string name_;
  std::string otherwise_;
  ImageShape shape_;
  std::uint32_t bits_ = 8;
  std::uint32_t fourcc_ = 0;
  std::size_t stride_ = 0;
  std::size_t needed_ = 0;  ///< bytes of a whole image
  std::int64_t period_ns_ = 0;
  std::vector<Mapping> mappings_;
  bool streaming_ = false;
  int errno_ = 0;
};

}  // namespace rptv
