// SPDX-License-Identifier: MIT
// Says which cameras' frames are of one instant: by trigger index, by time, or by an index whose offset the times give.
#pragma once

#include <array>
#include <cstdint>

#include "core/frame.hpp"
#include "core/losses.hpp"

namespace rptv {

enum class PairBy : std::uint8_t {
  index,           ///< equal indices are one instant; nothing checks it
  index_and_time,  ///< one trigger for all cameras: indices differ by fixed offsets, which the times give and check
  time,            ///< the cameras run freely: what lies within the tolerance is one instant
};

struct PairingOptions {
  PairBy by = PairBy::index;
  bool ptp = false;  ///< compare the cameras' own PTP times; else their times as mapped to the host's clock
  std::int64_t tolerance_ns = 0;  ///< how far times within one set may differ; less than half of the frame period
};

/// Compares the oldest frames held of each camera, their heads. Times and indices of one camera must increase.
///
/// By index and time: while no offsets are known, times decide. The first complete set fixes the offsets, and from then
/// on indices decide, which do not jitter; times must agree. Where they do not, a camera has missed a trigger or counts
/// anew, and where a camera shows nothing it may: both times the offsets are forgotten and found again.
///
/// One thread at a time; allocates nothing.
class Pairing {
 public:
  using Heads = std::array<const FrameInfo*, kMaxCameras>;  ///< null: this camera has none

  /// Cameras (bit 0: the first one) whose heads have no partner any more, because another camera has passed them.
  struct Passed {
    std::uint32_t cameras = 0;
    LossCause cause = LossCause::set_incomplete;
  };

  explicit Pairing(const PairingOptions& options) noexcept : options_(options) {}

  /// None passed: all heads that there are show one instant.
  Passed passed(const Heads& heads) noexcept;
  /// The heads, one of each camera, make a set: their indices belong together.
  void align(const Heads& heads) noexcept;
  /// A camera had nothing to show when a set was given up: when it returns, its indices may mean something else.
  void forget() noexcept { aligned_ = false; }

  bool by_index_alone() const noexcept { return options_.by == PairBy::index; }
  /// False: this frame's time is of a clock that cannot be compared.
  bool is_timed(const FrameInfo& info) const noexcept { return !options_.ptp || info.clock == ClockId::ptp; }
  std::int64_t time_ns(const FrameInfo& info) const noexcept {
    return options_.ptp ? info.exposure_end_ns : info.exposure_end_host_ns;
  }

 private:
  std::uint64_t number_of(std::size_t camera, const FrameInfo& info) const noexcept {
    return info.index + shift_[camera];
  }
  std::uint32_t behind_by_number(const Heads& heads) const noexcept;
  std::uint32_t behind_by_time(const Heads& heads) const noexcept;

  const PairingOptions options_;
  bool aligned_ = false;                            // offsets are known
  std::array<std::uint64_t, kMaxCameras> shift_{};  // to be added to an index; wraps where it is negative
};

}  // namespace rptv
