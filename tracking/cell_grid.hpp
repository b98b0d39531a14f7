// SPDX-License-Identifier: MIT
// Finds all points within a radius: points sorted into cells, rebuilt every frame in memory taken once.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace rptv {

/// Points are numbered by their place in cell order; original() gives the index in the input. Cells cover the points'
/// bounding box where that gives every point about a cell; where a few outliers would make all others share one, cells
/// are as small as the radius wants and hashed. Either way O(N) and bounded memory. One thread at a time.
class CellGrid {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;

  explicit CellGrid(std::size_t max_points);

  /// Sorts the first `count` points (at most max_points) of which all coordinates are finite; `radius` > 0.
  /// Coordinates of any unit; the radius in the same.
  void build(const double* x, const double* y, const double* z, std::size_t count, double radius) noexcept;

  std::size_t size() const noexcept { return size_; }
  std::uint32_t original(std::size_t place) const noexcept { return original_[place]; }
  /// Where input point i stands in cell order; kNone for a point that is not finite.
  std::uint32_t place(std::size_t i) const noexcept { return place_[i]; }
  double x(std::size_t place) const noexcept { return x_[place]; }
  double y(std::size_t place) const noexcept { return y_[place]; }
  double z(std::size_t place) const noexcept { return z_[place]; }

  /// Calls `visit(place, squared distance / radius²)` once for every point at most `radius` away until it returns
  /// false. The order depends on the points and on `spread`: in crowded cells, queries of different `spread` begin
  /// elsewhere.
  template <class Visit>
  void visit_near(double qx, double qy, double qz, std::size_t spread, Visit&& visit) const noexcept;

 private:
  /// Cells along one axis. cell() never decreases with v, whatever is rounded, so a range misses no point.
  struct Axis {
    double origin = 0, cells_per_unit = 0, last = 0;  // last: index of the last cell; points beyond share it
    std::uint32_t cell(double v) const noexcept {
      return static_cast<std::uint32_t>(std::clamp((v - origin) * cells_per_unit, 0.0, last));
    }
    bool range(double v, double reach, std::uint32_t& lo, std::uint32_t& hi) const noexcept {
      if (!std::isfinite(v)) return false;
      reach += 2 * std::numeric_limits<double>::epsilon() * std::abs(v);
      lo = cell(v - reach);
      hi = cell(v + reach);
      return true;
    }
  };

  template <class Visit>
  bool scan(std::uint32_t begin, std::uint32_t end, const std::array<double, 3>& q, Visit& visit) const noexcept;
  template <class Visit>
  bool scan_row(std::uint32_t begin, std::uint32_t end, const std::array<double, 3>& q, std::size_t spread,
                Visit& visit) const noexcept;
  std::uint32_t row_of(std::uint32_t iy, std::uint32_t iz) const noexcept {
    if (!hashed_) return (iz * rows_ + iy) * columns_;
    const std::uint64_t h = (iy + (std::uint64_t{iz} << 32)) * 0x9E3779B97F4A7C15ULL;
    return static_cast<std::uint32_t>((h ^ (h >> 29)) * 0xBF58476D1CE4E5B9ULL >> 32);
  }
  std::uint32_t cell_of(double px, double py, double pz) const noexcept {
    const std::uint32_t cell = row_of(axes_[1].cell(py), axes_[2].cell(pz)) + axes_[0].cell(px);
    return hashed_ ? cell & mask_ : cell;
  }
  std::size_t measure(const double* x, const double* y, const double* z, std::size_t count) noexcept;
  bool cover_box() noexcept;
  std::uint64_t most_shared() const noexcept;
  void hash_around(double x, double y, double z) noexcept;
  std::uint64_t count_cells(const double* x, const double* y, const double* z, std::size_t count) noexcept;
  void sort(const double* x, const double* y, const double* z, std::size_t count) noexcept;

  std::size_t size_ = 0;
  std::size_t cells_ = 1;
  bool hashed_ = false;
  std::uint32_t columns_ = 1, rows_ = 1, mask_ = 0;
  double per_radius_ = 1, reach_ = 1;
  std::array<Axis, 3> axes_;
  std::array<double, 3> low_{}, high_{};
  std::vector<std::uint32_t> cell_begin_, cell_of_point_, original_, place_;
  std::vector<double> x_, y_, z_;
};

template <class Visit>
bool CellGrid::scan(std::uint32_t begin, std::uint32_t end, const std::array<double, 3>& q,
                    Visit& visit) const noexcept {
  for (std::uint32_t place = begin; place < end; ++place) {
    const double dx = (x_[place] - q[0]) * per_radius_;
    const double dy = (y_[place] - q[1]) * per_radius_;
    const double dz = (z_[place] - q[2]) * per_radius_;
    const double cost = dx * dx + dy * dy + dz * dz;
    if (cost <= 1.0 && !visit(place, cost)) return false;
  }
  return true;
}

template <class Visit>
bool CellGrid::scan_row(std::uint32_t begin, std::uint32_t end, const std::array<double, 3>& q, std::size_t spread,
                        Visit& visit) const noexcept {
  constexpr std::uint32_t kCrowded = 64;
  if (end - begin < kCrowded) return scan(begin, end, q, visit);
  const auto middle = static_cast<std::uint32_t>(begin + spread % (end - begin));
  return scan(middle, end, q, visit) && scan(begin, middle, q, visit);
}

template <class Visit>
void CellGrid::visit_near(double qx, double qy, double qz, std::size_t spread, Visit&& visit) const noexcept {
  std::array<std::uint32_t, 3> lo, hi;
  const std::array<double, 3> q{qx, qy, qz};
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (!axes_[axis].range(q[axis], reach_, lo[axis], hi[axis])) return;
  for (std::uint32_t iz = lo[2]; iz <= hi[2]; ++iz)
    for (std::uint32_t iy = lo[1]; iy <= hi[1]; ++iy) {
      const std::uint32_t row = row_of(iy, iz);
      if (!hashed_) {
        if (!scan_row(cell_begin_[row + lo[0]], cell_begin_[row + hi[0] + 1], q, spread, visit)) return;
        continue;
      }
      auto visit_own = [&](std::uint32_t place, double cost) noexcept {  // other rows may have hashed to this cell
        return axes_[1].cell(y_[place]) != iy || axes_[2].cell(z_[place]) != iz || visit(place, cost);
      };
      for (std::uint32_t ix = lo[0]; ix <= hi[0]; ++ix) {
        const std::uint32_t cell = (row + ix) & mask_;
        if (!scan_row(cell_begin_[cell], cell_begin_[cell + 1], q, spread, visit_own)) return;
      }
    }
}

}  // namespace rptv
