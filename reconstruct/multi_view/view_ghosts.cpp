// SPDX-License-Identifier: MIT
// Groups rival sets by union-find, and picks the best of each group by branch and bound.
#include "reconstruct/multi_view/view_ghosts.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rptv {

namespace {

constexpr std::size_t kMostBranched = 64;  // firsts in a group, which is how deep branch() goes

/// View and number of the first detection.
std::uint64_t first_of(const ViewTuple& tuple) noexcept {
  std::uint64_t view = 0;
  while (tuple.detection[view] == kUnseen) ++view;
  return view << 32 | tuple.detection[view];
}

}  // namespace

ViewGhosts::ViewGhosts(std::size_t views, std::size_t max_detections, std::size_t max_matches,
                       const GhostOptions& options)
    : views_(views),
      options_(options),
      parent_(max_matches),
      next_(max_matches),
      order_(max_matches),
      weight_(max_matches),
      rest_(max_matches + 1) {
  for (auto* list : {&chosen_, &trial_, &best_}) list->reserve(max_matches);
  for (std::size_t v = 0; v < views; ++v) used_[v].resize(max_detections), owner_[v].resize(max_detections);
}

void ViewGhosts::clear() noexcept {
  for (auto& view : used_) std::fill(view.begin(), view.end(), std::uint8_t{0});
  counts_.weight = counts_.most_weight = 0;
}

double ViewGhosts::weight(const ViewMatch& match) const noexcept {
  return 2.0 * match.tuple.views - 3 - match.square_px2 / (options_.tolerance_px * options_.tolerance_px);
}

bool ViewGhosts::free(const ViewTuple& tuple) const noexcept {
  bool free = true;
  for (std::size_t v = 0; v < views_; ++v) free &= tuple.detection[v] == kUnseen || used_[v][tuple.detection[v]] == 0;
  return free;
}

void ViewGhosts::mark(const ViewTuple& tuple, std::uint8_t as) noexcept {
  for (std::size_t v = 0; v < views_; ++v)
    if (tuple.detection[v] != kUnseen) used_[v][tuple.detection[v]] = as;
}

std::uint32_t ViewGhosts::root(std::uint32_t number) noexcept {
  while (parent_[number] != number) number = parent_[number] = parent_[parent_[number]];
  return number;
}

// Union of all that share a detection.
void ViewGhosts::group(std::span<const ViewMatch> matches) noexcept {
  for (std::uint32_t m = 0; m < matches.size(); ++m) {
    parent_[m] = m, next_[m] = kUnseen;
    for (std::size_t v = 0; v < views_; ++v)
      if (matches[m].tuple.detection[v] != kUnseen) owner_[v][matches[m].tuple.detection[v]] = m;
  }
  for (std::uint32_t m = 0; m < matches.size(); ++m)
    for (std::size_t v = 0; v < views_; ++v) {
      if (matches[m].tuple.detection[v] == kUnseen) continue;
      const std::uint32_t a = root(m), b = root(owner_[v][matches[m].tuple.detection[v]]);
      parent_[std::max(a, b)] = std::min(a, b);
    }
}

std::span<const std::uint32_t> ViewGhosts::choose(std::span<const ViewMatch> matches) noexcept {
  chosen_.clear();
  for (std::uint32_t m = 0; m < matches.size(); ++m) order_[m] = m, weight_[m] = weight(matches[m]);
  if (options_.by_rank) {
    choose_by_rank(matches);
    return chosen_;
  }
  group(matches);
  // A group's root is its first match: groups come in order of their firsts, their members in order.
  for (auto m = static_cast<std::uint32_t>(matches.size()); m-- > 0;) {
    const std::uint32_t first = root(m);
    if (first != m) next_[m] = std::exchange(next_[first], m);
  }
  for (std::uint32_t first = 0; first < matches.size(); ++first) {
    if (parent_[first] != first) continue;
    if (next_[first] == kUnseen) {
      choose_alone(matches, first);
      continue;
    }
    std::size_t rivals = 0;
    for (std::uint32_t m = first; m != kUnseen; m = next_[m]) order_[rivals++] = m;
    choose_in(matches, std::span(order_).first(rivals));
  }
  return chosen_;
}

// What choose_in() makes of one without rivals.
void ViewGhosts::choose_alone(std::span<const ViewMatch> matches, std::uint32_t match) noexcept {
  if (weight_[match] <= 0 || !free(matches[match].tuple)) return;
  mark(matches[match].tuple, 1);
  chosen_.push_back(match);
  counts_.weight += weight_[match], counts_.most_weight += weight_[match];
}

void ViewGhosts::choose_by_rank(std::span<const ViewMatch> matches) noexcept {
  std::sort(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(matches.size()),
            [&](auto a, auto b) { return std::pair(matches[a].s, a) < std::pair(matches[b].s, b); });
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!free(matches[order_[i]].tuple)) continue;
    mark(matches[order_[i]].tuple, 1);
    chosen_.push_back(order_[i]);
  }
}

void ViewGhosts::choose_in(std::span<const ViewMatch> matches, std::span<std::uint32_t> rivals) noexcept {
  matches_ = matches, rivals_ = rivals;
  best_.clear(), trial_.clear();
  best_sum_ = 0, steps_ = 0;
  // Greedy: heaviest first. What it finds is at least 1/views of the best.
  std::sort(rivals.begin(), rivals.end(),
            [&](auto a, auto b) { return std::pair(-weight_[a], a) < std::pair(-weight_[b], b); });
  for (const std::uint32_t m : rivals) {
    if (weight_[m] <= 0 || !free(matches[m].tuple)) continue;
    mark(matches[m].tuple, 1);
    best_.push_back(m), best_sum_ += weight_[m];
  }
  for (const std::uint32_t m : best_) mark(matches[m].tuple, 0);
  // At most one of those that share their first detection: the sum of the heaviest of each is a bound.
  std::sort(rivals.begin(), rivals.end(), [&](auto a, auto b) {
    return std::tuple(first_of(matches[a].tuple), -weight_[a], a) <
           std::tuple(first_of(matches[b].tuple), -weight_[b], b);
  });
  std::size_t firsts = 0;
  rest_[rivals.size()] = 0;
  for (std::size_t i = rivals.size(); i-- > 0;) {
    const bool heaviest = i == 0 || first_of(matches[rivals[i - 1]].tuple) != first_of(matches[rivals[i]].tuple);
    rest_[i] = rest_[i + 1] + (heaviest ? std::max(weight_[rivals[i]], 0.0) : 0.0);
    firsts += heaviest ? 1 : 0;
  }
  double bound = rest_[0];
  if (best_sum_ < bound) {
    if (firsts <= kMostBranched) branch(0, 0);
    if (firsts <= kMostBranched && steps_ < kMostSteps)
      bound = best_sum_;
    else
      ++counts_.unproven;
  }
  for (const std::uint32_t m : best_) mark(matches[m].tuple, 1), chosen_.push_back(m);
  counts_.weight += best_sum_, counts_.most_weight += bound;
}

// Of the rivals from `first` on: one of those with the same first detection, or none of them.
void ViewGhosts::branch(std::size_t first, double sum) noexcept {
  if (sum > best_sum_) best_sum_ = sum, best_ = trial_;
  if (first == rivals_.size() || sum + rest_[first] <= best_sum_ || ++steps_ >= kMostSteps) return;
  const std::uint64_t key = first_of(matches_[rivals_[first]].tuple);
  std::size_t last = first;
  while (last < rivals_.size() && first_of(matches_[rivals_[last]].tuple) == key) ++last;
  for (std::size_t i = first; i < last; ++i) {
    const ViewMatch& match = matches_[rivals_[i]];
    if (weight_[rivals_[i]] <= 0 || !free(match.tuple)) continue;
    mark(match.tuple, 1);
    trial_.push_back(rivals_[i]);
    branch(last, sum + weight_[rivals_[i]]);
    trial_.pop_back();
    mark(match.tuple, 0);
  }
  branch(last, sum);
}

}  // namespace rptv
