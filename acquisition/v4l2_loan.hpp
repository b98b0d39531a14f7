// SPDX-License-Identifier: MIT
// Slots of the sink's pool that lie with a V4L2 driver, which writes its images straight into them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "acquisition/source.hpp"

namespace rptv {

/// Which of the driver's buffer numbers stands for which slot. Outlives the devices of all sessions of a camera. A slot
/// that comes back gets the number that it had, where that is free: the driver need not pin its pages anew. One thread
/// at a time; only claim() waits, and only under policy `lossless`.
class V4l2Loan {
 public:
  static constexpr std::size_t kMostBuffers = 32;  ///< the kernel's own limit

  /// `lent`: how many slots lie with the driver, 2 … kMostBuffers.
  V4l2Loan(std::uint32_t camera, std::size_t lent) noexcept : camera_(camera), lent_(lent) {}

  std::size_t lent() const noexcept { return lent_; }
  /// Claims slots until lent() are held, and numbers them from 0. Later ones may get any number below `numbers`, which
  /// is at least lent(). False when the sink has too few.
  bool claim(FrameSink& sink, std::size_t numbers) noexcept;
  /// The slot that the driver filled.
  FrameLease take(std::uint32_t number) noexcept;
  /// Its stand-in. Gives it a number.
  std::uint32_t put(FrameLease lease) noexcept;
  /// nullptr for a number without a slot.
  std::byte* memory(std::uint32_t number) const noexcept;
  /// Gives all slots back. The driver must not have them any more.
  void end() noexcept;

 private:
  struct Place {
    FrameLease lease;
    std::size_t slot = SIZE_MAX;  ///< the last one that had this number
  };
  const std::uint32_t camera_;
  const std::size_t lent_;
  std::size_t numbers_ = 0;
  std::array<Place, kMostBuffers> places_;
};

}  // namespace rptv
