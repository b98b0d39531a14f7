// SPDX-License-Identifier: MIT
// One open V4L2 capture device: set up, streaming, and its buffers one at a time.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "acquisition/v4l2_format.hpp"
#include "acquisition/v4l2_loan.hpp"
#include "acquisition/v4l2_settings.hpp"
#include "acquisition/v4l2_system.hpp"
#include "core/clock.hpp"
#include "core/image.hpp"

struct v4l2_buffer;

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
  enum class Took : std::uint8_t { image, nothing, changed, lost };

  /// `loan` must outlive this object.
  V4l2Device(V4l2System& system, const std::string& path, const V4l2Settings& settings, V4l2Loan& loan);
  ~V4l2Device();
  V4l2Device(const V4l2Device&) = delete;
  V4l2Device& operator=(const V4l2Device&) = delete;

  const ImageShape& shape() const noexcept { return shape_; }
  std::uint32_t significant_bits() const noexcept { return format_.significant_bits; }
  std::int64_t period_ns() const noexcept { return period_ns_; }  ///< 0: the driver does not say
  const std::string& name() const noexcept { return name_; }
  /// Format, buffers, memory, clock of the stamps. After start().
  std::string link() const;
  /// What the driver made of the controls otherwise than asked, with the next step; empty: nothing.
  const std::string& otherwise() const noexcept { return otherwise_; }

  /// Lends slots of `sink` or maps the driver's buffers, as v4l2.memory says, and begins to stream.
  void start(FrameSink& sink);
  /// Waits until a buffer is filled, `wake` becomes readable or the time is over. `lost`: the device is gone or failed,
  /// last_errno() says why. `changed`: its source has another size or rate now. No exception, no allocation.
  Took take(V4l2Image& image, int wake, int timeout_ms) noexcept;
  /// A slot with the image in it: `other`, or the driver's own, for which `other` stands in from now on. The image is
  /// to be given back afterwards.
  FrameLease exchange(V4l2Image& image, FrameLease other) noexcept;
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
  v4l2_buffer any_buffer(std::uint32_t number) const noexcept;
  // Set-up, in v4l2_setup.cpp:
  void set_timings();
  void set_format(const V4l2Settings& settings);
  void set_rate(double rate_hz);
  void set_controls(const std::vector<std::string>& wishes);
  // Buffers:
  std::uint32_t request_buffers(std::size_t count) noexcept;
  bool lend(FrameSink& sink) noexcept;
  void map();
  void close() noexcept;

  V4l2System& system_;
  const std::string path_;
  const V4l2Format& format_;
  const std::string memory_;
  const std::int64_t buffers_;
  V4l2Loan& loan_;
  int descriptor_ = -1;
  std::string name_, otherwise_;
  ImageShape shape_;
  std::size_t stride_ = 0;
  std::size_t needed_ = 0;      ///< bytes of a whole image
  std::size_t image_size_ = 0;  ///< bytes that the driver asks of a buffer
  std::int64_t period_ns_ = 0;
  std::uint32_t flags_ = 0;  ///< of a buffer before the first image: clock and instant of the stamps
  std::vector<Mapping> mappings_;
  bool lent_ = false;  ///< the driver writes into slots
  bool streaming_ = false;
  int errno_ = 0;
};

}  // namespace rptv
