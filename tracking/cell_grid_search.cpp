// SPDX-License-Identifier: MIT
// Searches the grid: the rows of cells that an ellipsoid meets, four points at a time.
#include <bit>

#include "tracking/cell_grid.hpp"
#include "tracking/near_mask.hpp"

namespace rptv {

namespace {

constexpr std::size_t kMostRows = 9;    // that a search meets
constexpr std::uint32_t kCrowded = 64;  // points in a row

}  // namespace

struct CellGrid::Query {
  Ellipsoid ellipsoid;
  std::size_t spread;
  Near* found;
  std::size_t most;
  std::size_t count;
};

std::uint32_t CellGrid::row_of(std::uint32_t iy, std::uint32_t iz) const noexcept {
  const std::uint64_t h = (iy + (std::uint64_t{iz} << 32)) * 0x9E3779B97F4A7C15ULL;
  return static_cast<std::uint32_t>((h ^ (h >> 29)) * 0xBF58476D1CE4E5B9ULL >> 32);
}

inline void CellGrid::scan(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept {
  for (std::uint32_t place = begin; place < end && query.count < query.most; place += 4) {
    double cost[4];
    std::uint32_t mask = near_mask(&x_[place], &y_[place], &z_[place], query.ellipsoid, cost) & lanes(place, end);
    for (; mask != 0; mask &= mask - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(mask));
      query.found[query.count++] = {cost[k], place + k};
    }
  }
  query.count = std::min(query.count, query.most);
}

/// A long row begins at a place that `spread` chooses, and ends before it.
inline void CellGrid::scan_row(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept {
  if (end - begin < kCrowded) return scan(begin, end, query);
  const auto middle = static_cast<std::uint32_t>(begin + query.spread % (end - begin));
  scan(middle, end, query);
  scan(begin, middle, query);
}

/// What is behind the first four points of each row; of crowded rows everything, which leaves them empty.
void CellGrid::scan_long(Stretch* rows, std::size_t count, Query& query) const noexcept {
  for (std::size_t k = 0; k < count; ++k) {
    auto& [begin, end] = rows[k];
    if (end - begin >= kCrowded) {
      scan_row(begin, end, query);
      end = begin;
    } else if (end - begin > 4) {
      scan(begin + 4, end, query);
    }
  }
}

/// Points of other rows may have hashed to this cell: they are found in their own.
void CellGrid::scan_hashed(std::uint32_t cell, std::uint32_t iy, std::uint32_t iz, Query& query) const noexcept {
  const std::size_t before = query.count;
  scan_row(cell_begin_[cell], cell_begin_[cell + 1], query);
  std::size_t kept = before;
  for (std::size_t i = before; i < query.count; ++i) {
    const std::uint32_t place = query.found[i].place;
    query.found[kept] = query.found[i];
    kept += axes_[1].cell(y_[place]) == iy && axes_[2].cell(z_[place]) == iz ? 1 : 0;
  }
  query.count = kept;
}

void CellGrid::find_hashed(Query& query) const noexcept {
  std::array<std::uint32_t, 3> lo{};
  std::array<std::uint32_t, 3> hi{};
  const std::array<double, 3> centre{query.ellipsoid.x, query.ellipsoid.y, query.ellipsoid.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lo[axis] = axes_[axis].cell(centre[axis] - reach_[axis]);
    hi[axis] = axes_[axis].cell(centre[axis] + reach_[axis]);
  }
  for (std::uint32_t iz = lo[2]; iz <= hi[2]; ++iz)
    for (std::uint32_t iy = lo[1]; iy <= hi[1]; ++iy)
      for (std::uint32_t ix = lo[0]; ix <= hi[0] && query.count < query.most; ++ix)
        scan_hashed((row_of(iy, iz) + ix) & mask_, iy, iz, query);
}

/// The first four points of every row, whether it has as many or not, then their hits together: how many points a row
/// has, and which are near, cannot be predicted.
std::size_t CellGrid::find_near(double qx, double qy, double qz, std::size_t spread, Near* found,
                                std::size_t most) const noexcept {
  if (!((qx - qx) + (qy - qy) + (qz - qz) == 0)) return 0;
  Query query{{qx, qy, qz, per_range_[0], per_range_[1], per_range_[2]}, spread, found, most, 0};
  if (hashed_) {
    find_hashed(query);
    return query.count;
  }
  const std::uint32_t from_x = axes_[0].window_from(qx, reach_[0]);
  const std::uint32_t from_y = axes_[1].window_from(qy, reach_[1]);
  const std::uint32_t from_z = axes_[2].window_from(qz, reach_[2]);
  Stretch rows[kMostRows];
  std::uint32_t row = 0;
  std::uint32_t longest = 0;
  for (std::uint32_t iz = from_z; iz < from_z + window_[2]; ++iz)
    for (std::uint32_t iy = from_y; iy < from_y + window_[1]; ++iy, ++row) {
      const std::uint32_t cell = (iz * rows_ + iy) * columns_ + from_x;
      rows[row] = {cell_begin_[cell], cell_begin_[cell + window_[0]]};
      longest = std::max(longest, rows[row].end - rows[row].begin);
    }
  if (longest > 4) scan_long(rows, row, query);
  double cost[4 * kMostRows];
  const auto near_in = set_ == InstructionSet::portable ? near_in_rows : near_in_rows_avx2;
  std::uint64_t near = near_in(x_.data(), y_.data(), z_.data(), rows, row, query.ellipsoid, cost);
  std::size_t count = query.count;
  for (; near != 0 && count < most; near &= near - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(near));
    found[count++] = {cost[k], rows[k / 4].begin + k % 4};
  }
  return count;
}

}  // namespace rptv
