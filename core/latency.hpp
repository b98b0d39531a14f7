// SPDX-License-Identifier: MIT
// Time stamps per stage and a histogram of durations with percentiles, both without allocation.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace rptv {

/// Points on the way of one frame, in order. Each is stamped when that step is complete, on CLOCK_MONOTONIC.
enum class Stage : std::uint8_t { exposure_end, arrived, bundled, reconstructed, linked, published, count_ };
inline constexpr std::size_t kStageCount = static_cast<std::size_t>(Stage::count_);

constexpr std::string_view name_of(Stage stage) noexcept {
  constexpr std::array<std::string_view, kStageCount> kNames{"exposure_end",  "arrived", "bundled",
                                                             "reconstructed", "linked",  "published"};
  return kNames[static_cast<std::size_t>(stage)];
}

/// Host time in ns at which each stage was done with this frame; 0: not reached.
struct Stamps {
  std::array<std::int64_t, kStageCount> at_ns{};
  std::int64_t& operator[](Stage stage) noexcept { return at_ns[static_cast<std::size_t>(stage)]; }
  std::int64_t operator[](Stage stage) const noexcept { return at_ns[static_cast<std::size_t>(stage)]; }
};

/// Log-linear histogram: 32 bins per octave, so a percentile is right within 1/32 of its value. One thread at a time.
class LatencyHistogram {
 public:
  void record(std::int64_t ns) noexcept {
    const std::uint64_t value = ns > 0 ? static_cast<std::uint64_t>(ns) : 0;
    ++bins_[bin_of(value)];
    ++count_;
    if (value > max_) max_ = value;
  }
  std::uint64_t count() const noexcept { return count_; }
  std::int64_t max_ns() const noexcept { return static_cast<std::int64_t>(max_); }

  /// Nearest rank: the smallest recorded duration such that at least `fraction` (0..1) of all are not longer, raised to
  /// its bin's upper edge (never above the maximum). 0 when empty.
  std::int64_t percentile_ns(double fraction) const noexcept {
    const double exact_rank = std::ceil(std::clamp(fraction, 0.0, 1.0) * static_cast<double>(count_));
    const std::uint64_t rank = std::clamp<std::uint64_t>(static_cast<std::uint64_t>(exact_rank), 1, count_ + 1);
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
      seen += bins_[bin];
      if (seen >= rank) return static_cast<std::int64_t>(std::min(upper_edge(bin), max_));
    }
    return static_cast<std::int64_t>(max_);  // only when empty, or when `fraction` rounds up past the last
  }

 private:
  static constexpr unsigned kSubBits = 5;
  static std::size_t bin_of(std::uint64_t value) noexcept {
    if (value < (1U << kSubBits)) return value;
    const auto octave = static_cast<unsigned>(std::bit_width(value)) - kSubBits - 1;
    return ((octave + 1) << kSubBits) + ((value >> octave) & ((1U << kSubBits) - 1));
  }
  static std::uint64_t upper_edge(std::size_t bin) noexcept {
    if (bin < (1U << kSubBits)) return bin;
    const auto octave = (bin >> kSubBits) - 1;
    return (((std::uint64_t{1} << kSubBits) + (bin & ((1U << kSubBits) - 1)) + 1) << octave) - 1;
  }
  std::array<std::uint64_t, (64 - kSubBits + 1) << kSubBits> bins_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ = 0;
};

}  // namespace rptv
