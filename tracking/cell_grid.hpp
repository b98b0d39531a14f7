// SPDX-License-Identifier: MIT
// Finds all points within a range: points sorted into cells, rebuilt every frame in memory taken once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/instruction_set.hpp"
#include "tracking/cell_axis.hpp"

namespace rptv {

struct Stretch;

/// Half-axes of the ellipsoid that is searched, in the unit of the coordinates; equal ones make a ball.
using SearchRange = std::array<double, 3>;

/// A point found: its place in the grid's order, and its cost Σ (difference / half-axis)², 0 … 1.
struct Near {
  double cost;
  std::uint32_t place;
};

/// Points are numbered by their place in cell order; original() gives the index in the input. Cells cover the points'
/// bounding box, and every search meets the same small number of rows of them; where a few outliers would make all
/// others share one cell, cells are as small as the range wants and hashed. Either way O(N) and bounded memory. One
/// thread at a time.
class CellGrid {
 public:
  static constexpr std::uint32_t kNone = UINT32_MAX;
  static constexpr std::size_t kSlack = 4;  ///< elements that find_near() may write beyond `most`

  explicit CellGrid(std::size_t max_points, InstructionSet set = best_instruction_set());

  /// Sorts the first `count` points (at most max_points) of which all coordinates are finite; half-axes > 0.
  void build(const double* x, const double* y, const double* z, std::size_t count, const SearchRange& range) noexcept;

  std::size_t size() const noexcept { return size_; }
  std::uint32_t original(std::size_t place) const noexcept { return original_[place]; }
  /// Where input point i stands in cell order; kNone for a point that is not finite.
  std::uint32_t place(std::size_t i) const noexcept { return place_[i]; }
  double x(std::size_t place) const noexcept { return x_[place]; }
  double y(std::size_t place) const noexcept { return y_[place]; }
  double z(std::size_t place) const noexcept { return z_[place]; }

  /// Writes the points of cost at most 1 from (qx, qy, qz), each once, to `found` (room for most + kSlack), ends when
  /// `most` are there, and returns their number. Order and choice depend on the points and on `spread`: in crowded
  /// cells, queries of different `spread` begin elsewhere.
  std::size_t find_near(double qx, double qy, double qz, std::size_t spread, Near* found,
                        std::size_t most) const noexcept;

  /// Place of the point of least cost for which accept(place) holds, looked for in growing shells of cells, at most
  /// kShells of them; kNone if there is none. In crowded or hashed cells it may be another near one.
  template <class Accept>
  std::uint32_t find_nearest(double qx, double qy, double qz, Accept&& accept) const noexcept;
  static constexpr std::uint32_t kShells = 4;

 private:
  struct Query;
  void scan(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept;
  void scan_row(std::uint32_t begin, std::uint32_t end, Query& query) const noexcept;
  void scan_long(Stretch* rows, std::size_t count, Query& query) const noexcept;
  void find_hashed(Query& query) const noexcept;
  void scan_hashed(std::uint32_t cell, std::uint32_t iy, std::uint32_t iz, Query& query) const noexcept;
  std::uint32_t row_of(std::uint32_t iy, std::uint32_t iz) const noexcept;
  std::size_t measure(const double* x, const double* y, const double* z, std::size_t count) noexcept;
  bool measure_axis(const double* values, std::size_t count, std::size_t axis) noexcept;
  bool cover_box() noexcept;
  std::uint64_t most_shared() const noexcept;
  void hash_around(double x, double y, double z) noexcept;
  template <bool hashed>
  std::uint64_t count_cells(const double* x, const double* y, const double* z, std::size_t count) noexcept;
  void sort(const double* x, const double* y, const double* z, std::size_t count) noexcept;

  InstructionSet set_;
  std::size_t size_ = 0;
  std::size_t cells_ = 1;
  bool hashed_ = false;
  std::uint32_t columns_ = 1, rows_ = 1, mask_ = 0;
  std::array<std::uint32_t, 3> window_{1, 1, 1};  // cells that a search meets along each axis
  SearchRange per_range_{1, 1, 1}, reach_{1, 1, 1};
  std::array<CellAxis, 3> axes_;
  std::array<double, 3> low_{}, high_{};
  bool all_finite_ = true;
  std::vector<std::uint32_t> cell_begin_, cell_of_point_, place_, original_;
  std::vector<double> x_, y_, z_;  // in cell order, with kSlack elements behind
};

}  // namespace rptv
