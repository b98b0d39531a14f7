// SPDX-License-Identifier: MIT
// Sorts points into strips and cells by counting.
#include "reconstruct/multi_view/strip_index.hpp"

#include <cmath>

namespace rptv {

StripIndex::StripIndex(std::size_t capacity, const std::array<double, 4>& range)
    : range_(range), most_cells_(4 * capacity + 64), start_(most_cells_ + 1), cell_(capacity), points_(capacity) {}

// About one point in a square as wide as a strip; half as long cells keep the ends of a strip's range short.
void StripIndex::build(const double* major, const double* minor, std::size_t count) noexcept {
  const double wide = std::max(range_[2] - range_[0], 1.0), high = std::max(range_[3] - range_[1], 1.0);
  const double side = std::sqrt(wide * high / static_cast<double>(count + 1));
  strips_ = std::min(static_cast<std::size_t>(wide / side) + 1, most_cells_ / 2);
  cells_ = std::min(static_cast<std::size_t>(2 * high / side) + 1, most_cells_ / strips_);
  strip_width_ = wide / static_cast<double>(strips_);
  per_strip_ = 1 / strip_width_;
  per_cell_ = static_cast<double>(cells_) / high;
  const std::size_t all = strips_ * cells_;
  std::fill_n(start_.begin(), all + 1, 0U);
  for (std::size_t i = 0; i < count; ++i) {
    if (major[i] != major[i]) continue;
    cell_[i] = static_cast<std::uint32_t>(strip_of(major[i]) * cells_ + cell_of(minor[i]));
    ++start_[cell_[i]];
  }
  std::uint32_t sum = 0;
  for (std::size_t c = 0; c < all; ++c) {
    sum += start_[c];
    start_[c] = sum;
  }
  start_[all] = sum;
  for (std::size_t i = count; i-- > 0;)
    if (major[i] == major[i]) points_[--start_[cell_[i]]] = {major[i], minor[i], static_cast<std::uint32_t>(i)};
}

}  // namespace rptv
