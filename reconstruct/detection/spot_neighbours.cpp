// SPDX-License-Identifier: MIT
// Near pairs of modelled spots, sorted into a list for each crowded one.
#include "reconstruct/detection/spot_neighbours.hpp"

#include <algorithm>
#include <cmath>

#include "reconstruct/detection/model_image.hpp"
#include "reconstruct/detection/spot_fit.hpp"

namespace rptv {

SpotNeighbours::SpotNeighbours(std::size_t most_spots, std::size_t most_crowded, InstructionSet set)
    : near_columns_(near_columns(set)) {
  modelled_.reserve(most_spots), starts_.reserve(most_spots), reach_px_.reserve(most_spots);
  begin_.reserve(most_spots + 2);
  entries_.reserve(kRoom * most_crowded), lists_.reserve(kRoom * most_crowded);
}

bool SpotNeighbours::find(std::span<const FittedSpot> spots, std::int32_t radius) noexcept {
  static_assert(SpotBatch::kMostRadius + ModelImage::kMostReach + kMove + 2 * ModelImage::kMostMove <= kMostReach);
  modelled_.clear(), starts_.clear(), reach_px_.clear(), entries_.clear();
  for (std::uint32_t i = 0; i < spots.size(); ++i)
    if (spots[i].modelled && spots[i].peak > 0) modelled_.push_back(i);
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(spots[a].start.y, spots[a].start.x) < std::pair(spots[b].start.y, spots[b].start.x);
  };
  if (!std::is_sorted(modelled_.begin(), modelled_.end(), before))  // new ones are at the end
    std::sort(modelled_.begin(), modelled_.end(), before);
  std::int32_t farthest = 0;
  for (const std::uint32_t i : modelled_) {
    starts_.push_back(spots[i].start), reach_px_.push_back(ModelImage::reach(spots[i]));
    farthest = std::max(farthest, reach_px_.back());
  }
  bool room = true;
  const auto enter = [&](std::size_t at, std::size_t other) {
    const FittedSpot &spot = spots[modelled_[at]], &near = spots[modelled_[other]];
    const auto seen = static_cast<double>(radius + reach_px_[other] + kMove);
    if (!spot.crowded || std::abs(spot.x_px - near.x_px) > seen || std::abs(spot.y_px - near.y_px) > seen) return;
    room = room && entries_.size() < entries_.capacity();
    if (room) entries_.emplace_back(modelled_[at], modelled_[other]);
  };
  const auto apart = radius + farthest + kMove + 2 * static_cast<std::int32_t>(ModelImage::kMostMove);
  each_near_pair(starts_, apart, near_columns_, [&](std::size_t i, std::size_t j) { enter(i, j), enter(j, i); });

  begin_.assign(spots.size() + 2, 0);  // counted two further on, so that filling moves each begin to its place
  for (const auto& entry : entries_) ++begin_[entry.first + 2];
  for (std::size_t i = 2; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  lists_.resize(entries_.size());
  for (const auto& [spot, other] : entries_) lists_[begin_[spot + 1]++] = other;
  return room;
}

}  // namespace rptv
