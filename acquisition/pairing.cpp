// SPDX-License-Identifier: MIT
// The comparisons of heads, and which of them decides.
#include "acquisition/pairing.hpp"

#include <algorithm>
#include <limits>

namespace rptv {

Pairing::Passed Pairing::passed(const Heads& heads) noexcept {
  if (options_.by == PairBy::index) return {behind_by_number(heads), LossCause::set_incomplete};
  if (!aligned_) return {behind_by_time(heads), LossCause::set_incomplete};
  if (const std::uint32_t behind = behind_by_number(heads); behind != 0) return {behind, LossCause::set_incomplete};
  const std::uint32_t askew = behind_by_time(heads);
  if (askew != 0) forget();
  return {askew, LossCause::set_skew};
}

void Pairing::align(const Heads& heads) noexcept {
  if (options_.by != PairBy::index_and_time || aligned_) return;
  for (std::size_t camera = 0; camera < kMaxCameras; ++camera)
    if (heads[camera] != nullptr) shift_[camera] = heads[0]->index - heads[camera]->index;
  aligned_ = true;
}

std::uint32_t Pairing::behind_by_number(const Heads& heads) const noexcept {
  std::uint64_t newest = 0;
  for (std::size_t camera = 0; camera < kMaxCameras; ++camera)
    if (heads[camera] != nullptr) newest = std::max(newest, number_of(camera, *heads[camera]));
  std::uint32_t behind = 0;
  for (std::size_t camera = 0; camera < kMaxCameras; ++camera)
    if (heads[camera] != nullptr && number_of(camera, *heads[camera]) < newest) behind |= 1U << camera;
  return behind;
}

std::uint32_t Pairing::behind_by_time(const Heads& heads) const noexcept {
  std::int64_t newest_ns = std::numeric_limits<std::int64_t>::min();
  for (const FrameInfo* head : heads)
    if (head != nullptr) newest_ns = std::max(newest_ns, time_ns(*head));
  // A hostile device may show any 64 bits: no difference of two of them overflows here, as none is negative.
  const auto behind_ns = [&](const FrameInfo& info) {
    return static_cast<std::uint64_t>(newest_ns) - static_cast<std::uint64_t>(time_ns(info));
  };
  std::uint32_t behind = 0;
  for (std::size_t camera = 0; camera < kMaxCameras; ++camera)
    if (heads[camera] != nullptr && behind_ns(*heads[camera]) > static_cast<std::uint64_t>(options_.tolerance_ns))
      behind |= 1U << camera;
  return behind;
}

}  // namespace rptv
