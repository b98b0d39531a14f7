// SPDX-License-Identifier: MIT
// Finds all points within a radius: points sorted into cells, rebuilt every frame in memory taken once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tracking/cell_axis.hpp"

namespace rptv {

/// A point found: its place in the grid's order, and its squared distance / radius², 0 … 1.
struct Near {
  double cost;
  std::uint32_t place;
};

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
  std::uint32_t original(std::size_t place) const noexcept { return points_[place].original; }
  /// Where input point i stands in cell order; kNone for a point that is not finite.
  std::uint32_t place(std::size_t i) const noexcept { return place_[i]; }
  double x(std::size_t place) const noexcept { return points_[place].x; }
  double y(std::size_t place) const noexcept { return points_[place].y; }
  double z(std::size_t place) const noexcept { return points_[place].z; }

  /// Writes the points at most `radius` from (qx, qy, qz), each once, to `found`, ends when `most` are there, and
  /// returns their number. Order and choice depend on the points and on `spread`:
  /// in crowded cells, queries of different `spread` begin elsewhere.
  std::size_t find_near(double qx, double qy, double qz, std::size_t spread, Near* found,
                        std::size_t most) const noexcept;

 private:
  struct Point {
    double x, y, z;
    std::uint32_t original;
  };
  struct Query {
    double x, y, z;
    std::size_t spread;
    Near* found;
    std::size_t most;
    std::size_t count;
  };
  void scan(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept;
  void scan_row(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept;
  void scan_hashed(std::uint32_t cell, std::uint32_t iy, std::uint32_t iz, Query& query) const noexcept;
  std::uint32_t row_of(std::uint32_t iy, std::uint32_t iz) const noexcept;
  std::uint32_t cell_of(double px, double py, double pz) const noexcept;
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
  std::array<CellAxis, 3> axes_;
  std::array<double, 3> low_{}, high_{};
  bool all_finite_ = true;
  std::vector<std::uint32_t> cell_begin_, cell_of_point_, place_;
  std::vector<Point> points_;
};

}  // namespace rptv
