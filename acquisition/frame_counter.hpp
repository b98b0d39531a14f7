// SPDX-License-Identifier: MIT
// Turns a camera's frame ids, which wrap and start again, into the frame index, which only grows.
#pragma once

#include <cstdint>

namespace rptv {

/// GigE Vision 1.x counts 1 … 65535 and then 1 again; 0 is never used. USB3 Vision and extended GigE ids have 64 bits.
/// V4L2 counts 32 bits from 0. An id of 16 or 32 bits that lies less than half a turn behind the newest is an old frame
/// that came late, else the count wrapped. Where 16 bits are expected, an id above 65535 shows that the camera counts
/// with more: from then on nothing wraps. One thread at a time.
class FrameCounter {
 public:
  enum class Width : std::uint8_t { bits16, bits32, bits64 };
  explicit FrameCounter(Width width = Width::bits16) noexcept : width_(width) {}

  /// The index of the frame with this id. Late and repeated frames get the index that they had or would have had.
  std::uint64_t index_of(std::uint64_t id) noexcept {
    if (fresh_) {
      fresh_ = false;
      newest_index_ = started_ ? newest_index_ + 1 + jump_ : id;
      started_ = true;
      newest_id_ = id;
      return newest_index_;
    }
    const std::uint64_t turn = width_ == Width::bits32 ? std::uint64_t{1} << 32 : 65535;
    const bool wraps = width_ == Width::bits32 || (width_ == Width::bits16 && id <= turn && newest_id_ <= turn);
    const std::uint64_t ahead = wraps ? (id + turn - newest_id_) % turn : id - newest_id_;
    const std::uint64_t half = wraps ? turn / 2 : std::uint64_t{1} << 63;
    if (ahead > half) {
      const std::uint64_t behind = wraps ? turn - ahead : newest_id_ - id;
      return newest_index_ > behind ? newest_index_ - behind : 0;
    }
    newest_id_ = id;
    return newest_index_ += ahead;
  }

  /// The camera was opened again and counts anew: its next frame gets a larger index than any before, `missed` further
  /// on than the next (0 when nobody knows how many it took meanwhile).
  void reopen(std::uint64_t missed) noexcept {
    fresh_ = true;
    jump_ = missed;
  }

  bool started() const noexcept { return started_; }

 private:
  Width width_;
  bool fresh_ = true, started_ = false;
  std::uint64_t newest_id_ = 0, newest_index_ = 0, jump_ = 0;
};

}  // namespace rptv
