// SPDX-License-Identifier: MIT
// Runs of lit pixels joined to components that are connected over edges and corners.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruct/detection/lit_runs.hpp"

namespace rptv {

/// All memory is taken by the constructor. One thread.
class LitComponents {
 public:
  /// Room for that many runs.
  explicit LitComponents(std::size_t runs);

  /// `runs` in raster order, no more than there is room for. Components are numbered by their first runs.
  void join(std::span<const LitRun> runs) noexcept;
  std::size_t size() const noexcept { return begin_.size() - 1; }
  /// Runs of one component, in raster order.
  std::span<const LitRun> operator[](std::size_t component) const noexcept {
    return {sorted_.data() + begin_[component], begin_[component + 1] - begin_[component]};
  }

 private:
  std::uint32_t root_of(std::uint32_t run) noexcept;
  void join_rows(std::span<const LitRun> runs) noexcept;

  std::vector<std::uint32_t> parent_;  // per run: one before it in the same component, or itself
  std::vector<std::uint32_t> component_, begin_;
  std::vector<LitRun> sorted_;  // by component
};

}  // namespace rptv
