// SPDX-License-Identifier: MIT
// Which of the sets of detections are particles: each detection explains one, and the choice is made for all together.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/multi_view/view_match.hpp"

namespace rptv {

struct GhostOptions {
  double tolerance_px = 1;  ///< as CorrespondenceOptions has it
  bool by_rank = false;     ///< the seed's way: in order of rising s, whoever comes first
};

/// Since construction, except where stated.
struct GhostCounts {
  std::uint64_t unproven = 0;          ///< groups of rivals whose best choice was not proven within kMostSteps
  double weight = 0, most_weight = 0;  ///< of the last choice, and a bound that no choice exceeds
};

/// A set of n views weighs 2n - 3 (what its 2n coordinates say beyond the three of a point), less its squared error in
/// tolerances: the chosen sets have the largest weight together of all choices where no detection is used twice
/// (weighted set packing). Sets that share detections, directly or by others, are one group; groups are independent.
/// A group is solved by branch and bound, in at most kMostSteps steps from the greedy choice. One thread at a time.
class ViewGhosts {
 public:
  static constexpr std::uint32_t kMostSteps = 20000;

  ViewGhosts(std::size_t views, std::size_t max_detections, std::size_t max_matches, const GhostOptions& options);

  /// Forgets which detections are used: a new frame.
  void clear() noexcept;
  /// Numbers of the chosen sets among `matches`, whose detections count as used from now on. Allocates nothing.
  std::span<const std::uint32_t> choose(std::span<const ViewMatch> matches) noexcept;
  bool used(std::size_t view, std::uint32_t detection) const noexcept { return used_[view][detection] != 0; }
  const GhostCounts& counts() const noexcept { return counts_; }

 private:
  double weight(const ViewMatch& match) const noexcept;
  bool free(const ViewTuple& tuple) const noexcept;
  void mark(const ViewTuple& tuple, std::uint8_t as) noexcept;
  std::uint32_t root(std::uint32_t number) noexcept;
  void group(std::span<const ViewMatch> matches) noexcept;
  void choose_by_rank(std::span<const ViewMatch> matches) noexcept;
  void choose_alone(std::span<const ViewMatch> matches, std::uint32_t match) noexcept;
  void choose_in(std::span<const ViewMatch> matches, std::span<std::uint32_t> rivals) noexcept;
  void branch(std::size_t first, double sum) noexcept;

  std::size_t views_;
  GhostOptions options_;
  std::array<std::vector<std::uint8_t>, kMaxViews> used_;
  std::array<std::vector<std::uint32_t>, kMaxViews> owner_;    ///< a match of each detection
  std::vector<std::uint32_t> parent_, next_, order_, chosen_;  ///< next_: of the same group, or kUnseen
  std::vector<double> weight_;

  // Of the group in branch(): its matches, those of the same first detection adjacent.
  std::span<const ViewMatch> matches_;
  std::span<const std::uint32_t> rivals_;
  std::vector<double> rest_;  ///< bound of what the rivals from here on can add
  std::vector<std::uint32_t> trial_, best_;
  double best_sum_ = 0;
  std::uint32_t steps_ = 0;
  GhostCounts counts_;
};

}  // namespace rptv
