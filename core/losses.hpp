// SPDX-License-Identifier: MIT
// Everything that can be lost on the way from exposure to subscriber, counted by cause.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rptv {

/// Why something did not arrive. One name per cause, published with every status message.
enum class LossCause : std::uint8_t {
  source_gap,          ///< frame index jumped: the camera, driver or recording never gave us these frames
  source_outage,       ///< an estimate: frames that were due by the clock while the camera was gone
  source_duplicate,    ///< the same frame index came twice; the second was dropped
  source_torn,         ///< frame arrived incomplete
  pool_empty,          ///< no free frame slot: every lease was out
  superseded,          ///< policy `newest`: replaced by a newer one before anybody took it
  over_bound,          ///< policy `bounded`: queue full
  set_incomplete,      ///< a camera's partner frames never came
  set_stale,           ///< frame older than the last published set
  result_pool_empty,   ///< reconstruction done but every result slot was out
  particle_overflow,   ///< more particles than the configured capacity
  track_overflow,      ///< more tracks than the configured capacity
  publish_backlog,     ///< publisher behind: message dropped
  writer_backlog,      ///< file writer behind: row set dropped
  after_close,         ///< came when the stream had been closed
  linking_cut,         ///< subnetworks of tracks that were only approximated: the linker's deadline came first
  set_skew,            ///< index fits its partners', time does not: sync.tolerance_us
  set_untimed,         ///< its time is of another clock than sets are paired by: no PTP under sync.mode 'ptp'
  frame_refused,       ///< frame set that reconstruction cannot use: another number of cameras, torn, or another shape
  view_refused,        ///< image that was missing, torn or of another shape: reconstructed without it
  too_few_views,       ///< frame set of which fewer images than multi_view.min_views were left
  detection_overflow,  ///< particle images beyond the room for them
  match_overflow,      ///< sets of particle images that may be one particle, beyond the room for them
  search_cut,          ///< particle images not searched for in other views: the frame's share of work was used up
  ray_overflow,        ///< lit pixels beyond light_field.max_rays
  candidate_overflow,  ///< places where particles may be, beyond the room for them
  count_               ///< number of causes, not a cause
};
inline constexpr std::size_t kLossCauseCount = static_cast<std::size_t>(LossCause::count_);

constexpr std::string_view name_of(LossCause cause) noexcept {
  constexpr std::array<std::string_view, kLossCauseCount> kNames{
      "source_gap",        "source_outage",      "source_duplicate", "source_torn",    "pool_empty",
      "superseded",        "over_bound",         "set_incomplete",   "set_stale",      "result_pool_empty",
      "particle_overflow", "track_overflow",     "publish_backlog",  "writer_backlog", "after_close",
      "linking_cut",       "set_skew",           "set_untimed",      "frame_refused",  "view_refused",
      "too_few_views",     "detection_overflow", "match_overflow",   "search_cut",     "ray_overflow",
      "candidate_overflow"};
  return kNames[static_cast<std::size_t>(cause)];
}

/// Counters by cause. Any thread may count or read; counts are exact, a snapshot is not atomic across causes.
class Losses {
 public:
  void count(LossCause cause, std::uint64_t n = 1) noexcept {
    counters_[static_cast<std::size_t>(cause)].fetch_add(n, std::memory_order_relaxed);
  }
  /// The total so far, from the only thread that counts this cause.
  void set(LossCause cause, std::uint64_t total) noexcept {
    counters_[static_cast<std::size_t>(cause)].store(total, std::memory_order_relaxed);
  }
  std::uint64_t of(LossCause cause) const noexcept {
    return counters_[static_cast<std::size_t>(cause)].load(std::memory_order_relaxed);
  }
  std::array<std::uint64_t, kLossCauseCount> snapshot() const noexcept {
    std::array<std::uint64_t, kLossCauseCount> values{};
    for (std::size_t i = 0; i < kLossCauseCount; ++i) values[i] = counters_[i].load(std::memory_order_relaxed);
    return values;
  }
  std::uint64_t total() const noexcept {
    std::uint64_t sum = 0;
    for (const auto value : snapshot()) sum += value;
    return sum;
  }

 private:
  std::array<std::atomic<std::uint64_t>, kLossCauseCount> counters_{};
};

}  // namespace rptv
