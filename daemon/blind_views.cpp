// SPDX-License-Identifier: MIT
// Lists of particle images compared with the second longest.
#include "daemon/blind_views.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rptv {

std::uint32_t blind_views(std::span<const Detections> views) noexcept {
  constexpr std::size_t kEnough = 20, kTimesMore = 20;
  std::size_t most = 0, second = 0;
  for (const Detections& view : views) {
    const std::size_t size = view.size();
    second = std::max(second, std::min(most, size));
    most = std::max(most, size);
  }
  std::uint32_t blind = 0;
  for (std::size_t c = 0; c < views.size(); ++c)
    if (second >= kEnough && kTimesMore * views[c].size() < second) blind |= 1U << c;
  return blind;
}

std::string blind_warning(const std::string& camera) {
  return fmt::format(
      "camera '{}' sees next to no particles and the others do: it is dark, saturated or covered; look at its images, "
      "and mend light, exposure or lens cap",
      camera);
}

void BlindViewCounter::begin(std::uint64_t number, const FrameSet& frames) noexcept {
  number_ = number, missing_ = 0;
  for (std::size_t c = 0; c < blind_.size(); ++c) missing_ |= frames.frames[c].view().data == nullptr ? 1U << c : 0;
}

void BlindViewCounter::see(std::span<const Detections> views) noexcept {
  const std::uint32_t blind = blind_views(views) & ~missing_;
  for (std::size_t c = 0; c < blind_.size(); ++c)
    if ((blind >> c & 1U) != 0 && blind_[c]++ == 0) first_[c] = number_;
  ++seen_;
}

}  // namespace rptv
