// SPDX-License-Identifier: MIT
// Union-find with path halving, then a stable counting sort of the tracks by subnetwork.
#include "tracking/subnet.hpp"

#include <algorithm>

namespace rptv {

namespace {
constexpr std::uint32_t kUnlabelled = UINT32_MAX;
}

Subnets::Subnets(std::size_t max_sources, std::size_t max_targets)
    : parent_(max_targets), label_(max_targets), net_of_(max_sources), begin_(max_sources + 2), members_(max_sources) {}

std::uint32_t Subnets::root(std::uint32_t target) noexcept {
  while (parent_[target] != target) {
    parent_[target] = parent_[parent_[target]];
    target = parent_[target];
  }
  return target;
}

void Subnets::split(const Candidates& candidates, std::span<const std::uint32_t> sources) noexcept {
  for (const std::uint32_t s : sources)
    for (const Candidate& c : candidates.of(s)) {
      parent_[c.place] = c.place;
      label_[c.place] = kUnlabelled;
    }
  for (const std::uint32_t s : sources) {
    std::uint32_t joined = root(candidates.of(s).front().place);
    for (const Candidate& c : candidates.of(s).subspan(1)) {
      const std::uint32_t other = root(c.place);
      if (other < joined) parent_[joined] = other;
      if (joined < other) parent_[other] = joined;
      joined = std::min(joined, other);
    }
  }
  count_ = 0;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    std::uint32_t& label = label_[root(candidates.of(sources[i]).front().place)];
    if (label == kUnlabelled) {
      label = static_cast<std::uint32_t>(count_++);
      begin_[label + 2] = 0;
    }
    net_of_[i] = label;
    ++begin_[label + 2];
  }
  begin_[0] = begin_[1] = 0;
  for (std::size_t net = 2; net < count_ + 2; ++net) begin_[net] += begin_[net - 1];
  for (std::size_t i = 0; i < sources.size(); ++i) members_[begin_[net_of_[i] + 1]++] = sources[i];
}

}  // namespace rptv
