// SPDX-License-Identifier: MIT
// Builds the grid by a counting sort of points into cells: measure the box, choose the cells, count, sort.
#include "tracking/cell_grid.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace rptv {

namespace {

constexpr double kCellsPerPoint = 1.75;    // where the range would allow more
constexpr double kMostCells = 2.0;         // per point
constexpr std::size_t kFewPoints = 64;     // fewer count as so many: cells cost little then
constexpr double kMargin = 1e-6;           // of the range: rounding never hides a point
constexpr double kFarAway = 1e8;           // in ranges from 0: beyond, rounding eats the margin
constexpr double kCoarseCell = 2.0;        // in ranges: a search meets 2 cells an axis
constexpr double kFineCell = 1.0;          // in ranges: 3 cells an axis, for crowded ranges
constexpr double kFineFrom = 4.0;          // points in a coarse cell, on average
constexpr double kHashedCells = 1U << 31;  // along one axis, around the cloud
constexpr std::uint64_t kCrowdedCell = 8;  // points that a point shares its cell with, on average

bool finite(double x, double y, double z) noexcept { return (x - x) + (y - y) + (z - z) == 0; }

}  // namespace

CellGrid::CellGrid(std::size_t max_points, InstructionSet set)
    : set_(set),
      cell_begin_(std::bit_ceil(static_cast<std::size_t>(kMostCells) * std::max(kFewPoints, max_points)) + 2),
      cell_of_point_(max_points),
      place_(max_points),
      original_(max_points),
      x_(max_points + kSlack),
      y_(max_points + kSlack),
      z_(max_points + kSlack) {}

void CellGrid::build(const double* x, const double* y, const double* z, std::size_t count,
                     const SearchRange& range) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    per_range_[axis] = 1.0 / range[axis];
    reach_[axis] = range[axis] * (1 + kMargin);
  }
  size_ = measure(x, y, z, count);
  hashed_ = !cover_box() || count_cells<false>(x, y, z, count) > most_shared();
  if (hashed_) {
    hash_around(x[count / 2], y[count / 2], z[count / 2]);
    count_cells<true>(x, y, z, count);
  }
  sort(x, y, z, count);
}

/// Several points at a time, as the next least value need not wait for the one before it.
bool CellGrid::measure_axis(const double* values, std::size_t count, std::size_t axis) noexcept {
  constexpr std::size_t kLanes = 8;
  double low[kLanes], high[kLanes], sum[kLanes];
  for (std::size_t k = 0; k < kLanes; ++k) {
    low[k] = high[k] = values[k % count];
    sum[k] = 0;
  }
  std::size_t i = 0;
  for (; i + kLanes <= count; i += kLanes)
    for (std::size_t k = 0; k < kLanes; ++k) {
      const double v = values[i + k];
      low[k] = v < low[k] ? v : low[k];
      high[k] = v > high[k] ? v : high[k];
      sum[k] += v - v;
    }
  for (; i < count; ++i) {
    low[0] = std::min(low[0], values[i]);
    high[0] = std::max(high[0], values[i]);
    sum[0] += values[i] - values[i];
  }
  low_[axis] = *std::min_element(low, low + kLanes);
  high_[axis] = *std::max_element(high, high + kLanes);
  return std::accumulate(sum, sum + kLanes, 0.0) == 0;
}

std::size_t CellGrid::measure(const double* x, const double* y, const double* z, std::size_t count) noexcept {
  all_finite_ = count == 0 || (measure_axis(x, count, 0) && measure_axis(y, count, 1) && measure_axis(z, count, 2));
  if (all_finite_ && count > 0) return count;
  constexpr double kHuge = std::numeric_limits<double>::max();
  low_ = {kHuge, kHuge, kHuge};
  high_ = {-kHuge, -kHuge, -kHuge};
  std::size_t finite_points = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!finite(x[i], y[i], z[i])) continue;
    ++finite_points;
    low_ = {std::min(low_[0], x[i]), std::min(low_[1], y[i]), std::min(low_[2], z[i])};
    high_ = {std::max(high_[0], x[i]), std::max(high_[1], y[i]), std::max(high_[2], z[i])};
  }
  if (finite_points == 0) low_ = high_ = {};
  return finite_points;
}

/// Pairs of points in one cell that are not worth hashing: what small cells cannot mend, or few.
std::uint64_t CellGrid::most_shared() const noexcept {
  const bool small = axes_[0].cells_per_unit * reach_[0] * kCoarseCell >= 1.0;
  return small ? UINT64_MAX : kCrowdedCell * size_;
}

/// Chooses the smallest cells that are worth their rows and not too many; false when the box has no finite size.
bool CellGrid::cover_box() noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (std::max(-low_[axis], high_[axis]) > kFarAway * reach_[axis]) return false;
  const auto points = static_cast<double>(std::max(kFewPoints, size_));
  double edge = kCoarseCell;
  for (int attempt = 0; attempt < 32; ++attempt) {
    double cells = 1;
    int wide_axes = 0;
    const double cells_met = edge == kFineCell ? 3 : 2;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double width = edge * reach_[axis];
      const double last = std::floor((high_[axis] - low_[axis]) / width);
      const double met = std::min(last + 1, cells_met);
      window_[axis] = static_cast<std::uint32_t>(met);
      axes_[axis] = {low_[axis], 1.0 / width, last, last + 1 - met};
      cells *= last + 1;
      wide_axes += last > 0 ? 1 : 0;
    }
    if (!std::isfinite(cells)) break;
    if (edge == kCoarseCell && cells * kFineFrom < static_cast<double>(size_)) {
      edge = kFineCell;
      continue;
    }
    const double most_cells = points * (edge == kFineCell ? kMostCells : kCellsPerPoint);
    if (cells <= most_cells) {
      columns_ = static_cast<std::uint32_t>(axes_[0].last) + 1;
      rows_ = static_cast<std::uint32_t>(axes_[1].last) + 1;
      cells_ = static_cast<std::size_t>(cells);
      return true;
    }
    edge = std::max(edge, kCoarseCell) * 1.01 * std::pow(cells / most_cells, 1.0 / wide_axes);
  }
  return false;
}

/// Cells of fixed size in all of space; what is too far from (x, y, z) to be numbered shares the outermost cells.
void CellGrid::hash_around(double x, double y, double z) noexcept {
  const std::array<double, 3> centre{x, y, z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double width = kCoarseCell * reach_[axis];
    const double middle = std::isfinite(centre[axis]) ? centre[axis] : 0.0;
    axes_[axis] = {middle - width * (kHashedCells / 2), 1.0 / width, kHashedCells, kHashedCells};
  }
  cells_ = cell_begin_.size() - 2;
  mask_ = static_cast<std::uint32_t>(cells_ - 1);
}

/// Returns the number of pairs of points that share a cell.
template <bool hashed>
std::uint64_t CellGrid::count_cells(const double* x, const double* y, const double* z, std::size_t count) noexcept {
  std::fill_n(cell_begin_.begin(), cells_ + 2, 0U);
  std::uint64_t shared = 0;
  const std::array<CellAxis, 3> axes = axes_;
  for (std::size_t i = 0; i < count; ++i) {
    if (!all_finite_ && !finite(x[i], y[i], z[i])) {
      cell_of_point_[i] = kNone;
      continue;
    }
    std::uint32_t cell = 0;
    if constexpr (hashed)
      cell = (row_of(axes[1].cell(y[i]), axes[2].cell(z[i])) + axes[0].cell(x[i])) & mask_;
    else
      cell = (axes[2].cell(z[i]) * rows_ + axes[1].cell(y[i])) * columns_ + axes[0].cell(x[i]);
    cell_of_point_[i] = cell;
    shared += cell_begin_[cell + 2]++;
  }
  return shared;
}

void CellGrid::sort(const double* x, const double* y, const double* z, std::size_t count) noexcept {
  std::uint32_t begin = 0;
  for (std::size_t c = 2; c < cells_ + 2; ++c) begin = cell_begin_[c] += begin;
  // Now cell_begin_[c + 1] is where cell c begins; filling it moves that on to where cell c ends.
  for (std::size_t i = 0; i < count; ++i) {
    if (cell_of_point_[i] == kNone) {
      place_[i] = kNone;
      continue;
    }
    const std::uint32_t place = cell_begin_[cell_of_point_[i] + 1]++;
    place_[i] = place;
    original_[place] = static_cast<std::uint32_t>(i);
  }
  // Fetched from all over, rather than written all over: a processor waits for few loads at once, but for every store.
  for (std::size_t place = 0; place < size_; ++place) {
    const std::uint32_t i = original_[place];
    x_[place] = x[i];
    y_[place] = y[i];
    z_[place] = z[i];
  }
}

}  // namespace rptv
