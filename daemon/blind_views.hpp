// SPDX-License-Identifier: MIT
// Cameras that see next to nothing while the others see particles: dark, saturated or covered ones.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/frame.hpp"
#include "reconstruct/multi_view/view_observer.hpp"

namespace rptv {

/// Cameras (bit 0: the first one) with less than a twentieth of the particle images that two others have at least, when
/// those are 20 or more. Any thread; allocates nothing.
std::uint32_t blind_views(std::span<const Detections> views) noexcept;

/// What a person is to do about one.
std::string blind_warning(const std::string& camera);

/// Counts, over the frame sets of a recording, in how many each camera was blind. One thread.
class BlindViewCounter final : public ViewObserver {
 public:
  explicit BlindViewCounter(std::size_t cameras) : blind_(cameras), first_(cameras) {}
  /// The next frame set that is shown is this one; cameras without an image of it do not count as blind.
  void begin(std::uint64_t number, const FrameSet& frames) noexcept;
  void see(std::span<const Detections> views) noexcept override;
  std::uint64_t seen() const noexcept { return seen_; }
  std::uint64_t blind(std::size_t camera) const noexcept { return blind_[camera]; }
  /// Number of the first such frame set; only where blind() > 0.
  std::uint64_t first(std::size_t camera) const noexcept { return first_[camera]; }

 private:
  std::uint64_t seen_ = 0, number_ = 0;
  std::uint32_t missing_ = 0;
  std::vector<std::uint64_t> blind_, first_;
};

}  // namespace rptv
