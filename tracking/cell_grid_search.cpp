// SPDX-License-Identifier: MIT
// Searches the grid: the rows of cells that a ball meets, scanned point by point.
#include "tracking/cell_grid.hpp"

namespace rptv {

std::uint32_t CellGrid::row_of(std::uint32_t iy, std::uint32_t iz) const noexcept {
  if (!hashed_) return (iz * rows_ + iy) * columns_;
  const std::uint64_t h = (iy + (std::uint64_t{iz} << 32)) * 0x9E3779B97F4A7C15ULL;
  return static_cast<std::uint32_t>((h ^ (h >> 29)) * 0xBF58476D1CE4E5B9ULL >> 32);
}

/// Every point is written and only counted when it is near: whether it is cannot be predicted.
inline void CellGrid::scan(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept {
  const double qx = query.x;
  const double qy = query.y;
  const double qz = query.z;
  std::size_t count = query.count;
  for (std::uint32_t place = begin; place < end && count < query.most; ++place) {
    const Point& p = points_[place];
    const double dx = (p.x - qx) * per_radius_;
    const double dy = (p.y - qy) * per_radius_;
    const double dz = (p.z - qz) * per_radius_;
    const double cost = dx * dx + dy * dy + dz * dz;
    query.found[count] = {cost, place};
    count += cost <= 1.0 ? 1 : 0;
  }
  query.count = count;
}

/// A long row begins at a place that `spread` chooses, and ends before it.
inline void CellGrid::scan_row(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept {
  constexpr std::uint32_t kCrowded = 64;
  if (end - begin < kCrowded) return scan(begin, end, query);
  const auto middle = static_cast<std::uint32_t>(begin + query.spread % (end - begin));
  scan(middle, end, query);
  scan(begin, middle, query);
}

/// Points of other rows may have hashed to this cell: they are found in their own.
void CellGrid::scan_hashed(std::uint32_t cell, std::uint32_t iy, std::uint32_t iz, Query& query) const noexcept {
  const std::size_t before = query.count;
  scan_row(cell_begin_[cell], cell_begin_[cell + 1], query);
  std::size_t kept = before;
  for (std::size_t i = before; i < query.count; ++i) {
    const Point& p = points_[query.found[i].place];
    query.found[kept] = query.found[i];
    kept += axes_[1].cell(p.y) == iy && axes_[2].cell(p.z) == iz ? 1 : 0;
  }
  query.count = kept;
}

std::size_t CellGrid::find_near(double qx, double qy, double qz, std::size_t spread, Near* found,
                                std::size_t most) const noexcept {
  std::array<std::uint32_t, 3> lo{};
  std::array<std::uint32_t, 3> hi{};
  const bool finite = axes_[0].range(qx, reach_, lo[0], hi[0]) && axes_[1].range(qy, reach_, lo[1], hi[1]) &&
                      axes_[2].range(qz, reach_, lo[2], hi[2]);
  if (!finite) return 0;
  Query query{qx, qy, qz, spread, found, most, 0};
  for (std::uint32_t iz = lo[2]; iz <= hi[2]; ++iz)
    for (std::uint32_t iy = lo[1]; iy <= hi[1]; ++iy) {
      const std::uint32_t row = row_of(iy, iz);
      if (!hashed_)
        scan_row(cell_begin_[row + lo[0]], cell_begin_[row + hi[0] + 1], query);
      else
        for (std::uint32_t ix = lo[0]; ix <= hi[0]; ++ix) scan_hashed((row + ix) & mask_, iy, iz, query);
    }
  return query.count;
}

}  // namespace rptv
