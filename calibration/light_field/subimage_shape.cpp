// SPDX-License-Identifier: MIT
// Moments of sub-images.
#include "calibration/light_field/subimage_shape.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

struct Spread {
  double xx, xy, yy;
};
Spread spread_of(const SubimageMoments& m) noexcept {
  const double x = m.x / m.light, y = m.y / m.light;
  return {m.xx / m.light - x * x, m.xy / m.light - x * y, m.yy / m.light - y * y};
}

}  // namespace

void SubimageMoments::add(const SubimageMoments& other) noexcept {
  light += other.light, x += other.x, y += other.y;
  xx += other.xx, xy += other.xy, yy += other.yy;
  cells += other.cells;
}

double SubimageMoments::area_px2() const noexcept {
  if (!(light > 0)) return 0;
  const auto [a, b, c] = spread_of(*this);
  return std::sqrt(std::max(a * c - b * b, 0.0));
}

double SubimageMoments::axis_ratio() const noexcept {
  if (!(light > 0)) return 0;
  const auto [a, b, c] = spread_of(*this);
  const double middle = 0.5 * (a + c), half = std::hypot(0.5 * (a - c), b);
  return middle > half && middle > 0 ? std::sqrt((middle - half) / (middle + half)) : 0;
}

SubimageMoments moments_of(const GreyImage& image, std::array<double, 2> at_px, double radius_px, double dark) {
  SubimageMoments m;
  const int reach = static_cast<int>(std::ceil(radius_px));
  const int i0 = static_cast<int>(std::lround(at_px[0])), j0 = static_cast<int>(std::lround(at_px[1]));
  for (int j = std::max(0, j0 - reach); j <= std::min(image.height - 1, j0 + reach); ++j)
    for (int i = std::max(0, i0 - reach); i <= std::min(image.width - 1, i0 + reach); ++i) {
      const double dx = i - at_px[0], dy = j - at_px[1], grey = image.at(i, j) - dark;
      if (dx * dx + dy * dy <= radius_px * radius_px)
        m.add({grey, grey * dx, grey * dy, grey * dx * dx, grey * dx * dy, grey * dy * dy});
    }
  m.cells = 1;
  return m;
}

std::vector<SubimageMoments> sum_over_neighbours(const std::vector<SubimageMoments>& moments, int columns, int reach) {
  std::vector<SubimageMoments> along(moments.size()), sums(moments.size());
  const int rows = static_cast<int>(moments.size()) / columns;
  const auto index = [&](int row, int column) {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (int k = std::max(0, column - reach); k <= std::min(columns - 1, column + reach); ++k)
        along[index(row, column)].add(moments[index(row, k)]);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (int k = std::max(0, row - reach); k <= std::min(rows - 1, row + reach); ++k)
        sums[index(row, column)].add(along[index(k, column)]);
  return sums;
}

}  // namespace rptv
