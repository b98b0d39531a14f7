// SPDX-License-Identifier: MIT
// Splits the choices of a frame into connected subnetworks, which can be solved one by one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "tracking/candidates.hpp"

namespace rptv {

/// Tracks are in one subnetwork when a chain of shared candidates joins them (union-find over the particles).
/// Subnetworks come in the order of their first track, tracks in their own order. One thread; split() does not
/// allocate.
class Subnets {
 public:
  Subnets(std::size_t max_sources, std::size_t max_targets);

  /// `sources`: tracks with at least one candidate each, ascending.
  void split(const Candidates& candidates, std::span<const std::uint32_t> sources) noexcept;

  std::size_t size() const noexcept { return count_; }
  std::span<const std::uint32_t> operator[](std::size_t subnet) const noexcept {
    return {members_.data() + begin_[subnet], members_.data() + begin_[subnet + 1]};
  }

 private:
  std::uint32_t root(std::uint32_t target) noexcept;

  std::size_t count_ = 0;
  std::vector<std::uint32_t> parent_;  // per target: towards the root
  std::vector<std::uint32_t> label_;   // per root target: its subnetwork
  std::vector<std::uint32_t> net_of_;  // per listed source
  std::vector<std::uint32_t> begin_, members_;
};

}  // namespace rptv
