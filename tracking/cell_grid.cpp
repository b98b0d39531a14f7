// SPDX-License-Identifier: MIT
// Builds the grid by a counting sort of points into cells: measure the box, choose the cells, count, sort.
#include "tracking/cell_grid.hpp"

#include <bit>
#include <cmath>
#include <limits>

namespace rptv {

namespace {

constexpr double kCellsPerPoint = 2.0;     // measured optimum is flat between 1 and 4
constexpr double kFinestCell = 0.5;        // in radii: smaller cells cost more rows than they save points
constexpr double kHashedCell = 2.0;        // in radii: a ball then meets two cells an axis
constexpr double kHashedCells = 1U << 31;  // along one axis, around the cloud
constexpr std::uint64_t kCrowdedCell = 8;  // points that a point shares its cell with, on average

bool finite(double x, double y, double z) noexcept { return (x - x) + (y - y) + (z - z) == 0; }

}  // namespace

CellGrid::CellGrid(std::size_t max_points)
    : cell_begin_(std::bit_ceil(std::max<std::size_t>(64, static_cast<std::size_t>(kCellsPerPoint) * max_points)) + 2),
      cell_of_point_(max_points),
      place_(max_points),
      points_(max_points) {}

void CellGrid::build(const double* x, const double* y, const double* z, std::size_t count, double radius) noexcept {
  per_radius_ = 1.0 / radius;
  size_ = measure(x, y, z, count);
  reach_ = radius * (1 + 1e-9);  // rounding never hides a point
  hashed_ = false;
  hashed_ = !cover_box() || count_cells(x, y, z, count) > most_shared();
  if (hashed_) {
    hash_around(x[count / 2], y[count / 2], z[count / 2]);
    count_cells(x, y, z, count);
  }
  sort(x, y, z, count);
}

std::size_t CellGrid::measure(const double* x, const double* y, const double* z, std::size_t count) noexcept {
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
  all_finite_ = finite_points == count;
  return finite_points;
}

/// Pairs of points in one cell that are not worth hashing: what small cells cannot mend, or few.
std::uint64_t CellGrid::most_shared() const noexcept {
  const bool small = axes_[0].cells_per_unit * reach_ * kHashedCell >= 1.0;
  return small ? UINT64_MAX : kCrowdedCell * size_;
}

/// Chooses the smallest cells that are worth their rows and not too many; false when the box has no finite size.
bool CellGrid::cover_box() noexcept {
  const double most_cells = std::max(64.0, kCellsPerPoint * static_cast<double>(size_));
  double edge = kFinestCell * reach_;
  for (int attempt = 0; attempt < 32; ++attempt) {
    double cells = 1;
    int wide_axes = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      axes_[axis] = {low_[axis], 1.0 / edge, std::floor((high_[axis] - low_[axis]) / edge)};
      cells *= axes_[axis].last + 1;
      wide_axes += axes_[axis].last > 0 ? 1 : 0;
    }
    if (!std::isfinite(cells)) break;
    if (cells <= most_cells) {
      columns_ = static_cast<std::uint32_t>(axes_[0].last) + 1;
      rows_ = static_cast<std::uint32_t>(axes_[1].last) + 1;
      cells_ = static_cast<std::size_t>(cells);
      return true;
    }
    edge *= 1.01 * std::pow(cells / most_cells, 1.0 / wide_axes);
  }
  return false;
}

/// Cells of fixed size in all of space; what is too far from (x, y, z) to be numbered shares the outermost cells.
void CellGrid::hash_around(double x, double y, double z) noexcept {
  const double edge = kHashedCell * reach_;
  const std::array<double, 3> centre{x, y, z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double middle = std::isfinite(centre[axis]) ? centre[axis] : 0.0;
    axes_[axis] = {middle - edge * (kHashedCells / 2), 1.0 / edge, kHashedCells};
  }
  cells_ = cell_begin_.size() - 2;
  mask_ = static_cast<std::uint32_t>(cells_ - 1);
}

std::uint32_t CellGrid::cell_of(double px, double py, double pz) const noexcept {
  const std::uint32_t cell = row_of(axes_[1].cell(py), axes_[2].cell(pz)) + axes_[0].cell(px);
  return hashed_ ? cell & mask_ : cell;
}

/// Returns the number of pairs of points that share a cell.
std::uint64_t CellGrid::count_cells(const double* x, const double* y, const double* z, std::size_t count) noexcept {
  std::fill_n(cell_begin_.begin(), cells_ + 2, 0U);
  std::uint64_t shared = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!all_finite_ && !finite(x[i], y[i], z[i])) {
      cell_of_point_[i] = kNone;
      continue;
    }
    const std::uint32_t cell = cell_of(x[i], y[i], z[i]);
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
    points_[place] = {x[i], y[i], z[i], static_cast<std::uint32_t>(i)};
  }
}

}  // namespace rptv
