// SPDX-License-Identifier: MIT
// Union and find over runs that touch, row by row; then the runs sorted by component.
#include "reconstruct/detection/lit_components.hpp"

#include <algorithm>
#include <utility>

namespace rptv {

LitComponents::LitComponents(std::size_t runs) {
  parent_.reserve(runs), component_.reserve(runs), sorted_.reserve(runs);
  begin_.reserve(runs + 1);
  begin_.push_back(0);
}

std::uint32_t LitComponents::root_of(std::uint32_t run) noexcept {
  while (parent_[run] != run) {
    parent_[run] = parent_[parent_[run]];
    run = parent_[run];
  }
  return run;
}

// The earlier root stays root, so that components are numbered in raster order.
void LitComponents::join_rows(std::span<const LitRun> runs) noexcept {
  std::uint32_t above = 0;
  for (std::uint32_t i = 0; i < runs.size(); ++i) {
    parent_.push_back(i);
    const LitRun& run = runs[i];
    while (runs[above].y + 1 < run.y || (runs[above].y + 1 == run.y && runs[above].end_x < run.first_x)) ++above;
    // one that reaches further than this run is looked at again for the next: `above` stays
    for (std::uint32_t k = above; runs[k].y + 1 == run.y && runs[k].first_x <= run.end_x; ++k) {
      const std::uint32_t a = root_of(k), b = root_of(i);
      parent_[std::max(a, b)] = std::min(a, b);
    }
  }
}

void LitComponents::join(std::span<const LitRun> runs) noexcept {
  parent_.clear(), component_.clear(), begin_.clear();
  join_rows(runs);
  for (std::uint32_t i = 0; i < runs.size(); ++i) {  // a root comes before what hangs on it
    const std::uint32_t root = root_of(i);
    if (root == i) {
      component_.push_back(static_cast<std::uint32_t>(begin_.size()));
      begin_.push_back(1);
    } else {
      component_.push_back(component_[root]);
      ++begin_[component_[root]];
    }
  }
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : begin_) sum += std::exchange(begin, sum);
  sorted_.resize(runs.size());
  for (std::size_t i = 0; i < runs.size(); ++i) sorted_[begin_[component_[i]]++] = runs[i];
  begin_.insert(begin_.begin(), 0);  // each has moved on to where the next one begins
}

}  // namespace rptv
