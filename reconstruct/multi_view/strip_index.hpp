// SPDX-License-Identifier: MIT
// Which points of an image are near a line or a place: points sorted into strips, and along each strip.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rptv {

/// Points of the plane in strips of equal width across the first coordinate ("major"), each cut into cells along the
/// second ("minor"). A cell's points are adjacent, so are the cells of a strip: what is near a line is one range a
/// strip. Takes memory for `capacity` points at construction; build() and the searches allocate nothing.
class StripIndex {
 public:
  struct Point {
    double major, minor;
    std::uint32_t number;
  };

  StripIndex() = default;
  /// `range`: from major, minor, to major, minor; points beyond it are put into the cells at its edge.
  StripIndex(std::size_t capacity, const std::array<double, 4>& range);

  /// Sorts `count` points in; point i is (major[i], minor[i]), and left out where major[i] is not a number.
  void build(const double* major, const double* minor, std::size_t count) noexcept;

  /// visit(point) for every point within `reach` (along minor) of the segment between two points, ends included.
  template <class Visit>
  void along(double from_major, double from_minor, double to_major, double to_minor, double reach,
             const Visit& visit) const noexcept;

  /// visit(point) for every point of a box of half-widths `reach_major`, `reach_minor`.
  template <class Visit>
  void around(double major, double minor, double reach_major, double reach_minor, const Visit& visit) const noexcept;

 private:
  static std::size_t clamped(double cell, std::size_t cells) noexcept {
    return cell > 0 ? std::min(static_cast<std::size_t>(cell), cells - 1) : 0;
  }
  std::size_t strip_of(double major) const noexcept { return clamped((major - range_[0]) * per_strip_, strips_); }
  std::size_t cell_of(double minor) const noexcept { return clamped((minor - range_[1]) * per_cell_, cells_); }

  std::array<double, 4> range_{};
  std::size_t strips_ = 1, cells_ = 1;  // cells of each strip
  double strip_width_ = 1, per_strip_ = 1, per_cell_ = 1;
  std::size_t most_cells_ = 0;
  std::vector<std::uint32_t> start_;  // of each cell in points_, and the end
  std::vector<std::uint32_t> cell_;   // of each point given
  std::vector<Point> points_;
};

template <class Visit>
void StripIndex::along(double from_major, double from_minor, double to_major, double to_minor, double reach,
                       const Visit& visit) const noexcept {
  if (from_major > to_major) std::swap(from_major, to_major), std::swap(from_minor, to_minor);
  const double slope = (to_minor - from_minor) / std::max(to_major - from_major, 1e-9);
  const std::size_t last = strip_of(to_major);
  for (std::size_t strip = strip_of(from_major); strip <= last; ++strip) {
    const double edge = range_[0] + static_cast<double>(strip) * strip_width_;
    const double begin = strip == 0 ? from_major : std::clamp(edge, from_major, to_major);
    const double end = strip + 1 == strips_ ? to_major : std::clamp(edge + strip_width_, from_major, to_major);
    const double a = from_minor + slope * (begin - from_major), b = from_minor + slope * (end - from_major);
    const std::uint32_t* row = &start_[strip * cells_];
    const std::uint32_t until = row[cell_of(std::max(a, b) + reach) + 1];
    for (std::uint32_t i = row[cell_of(std::min(a, b) - reach)]; i < until; ++i) {
      const Point& point = points_[i];
      if (point.major < from_major || point.major > to_major) continue;
      const double off = point.minor - (from_minor + slope * (point.major - from_major));
      if (off <= reach && off >= -reach) visit(point);
    }
  }
}

template <class Visit>
void StripIndex::around(double major, double minor, double reach_major, double reach_minor,
                        const Visit& visit) const noexcept {
  const std::size_t first = cell_of(minor - reach_minor), until = cell_of(minor + reach_minor) + 1;
  const std::size_t last = strip_of(major + reach_major);
  for (std::size_t strip = strip_of(major - reach_major); strip <= last; ++strip)
    for (std::uint32_t i = start_[strip * cells_ + first]; i < start_[strip * cells_ + until]; ++i)
      if (std::abs(points_[i].major - major) <= reach_major && std::abs(points_[i].minor - minor) <= reach_minor)
        visit(points_[i]);
}

}  // namespace rptv
