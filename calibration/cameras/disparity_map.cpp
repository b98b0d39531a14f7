// SPDX-License-Identifier: MIT
// The spot is found by boxes against rings of cells, then placed by mean shift (Comaniciu and Meer 2002).
#include "calibration/cameras/disparity_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"

namespace rptv {
namespace {

constexpr int kSide = DisparityMap::kCells;
constexpr int kBox = 3, kInner = 6, kMiddle = 9, kOuter = 13;  // cells on either side of the middle one
constexpr double kWindowCells = 3;                             // sigma of the mean shift's window, cells
constexpr int kReachCells = 9;                                 // where it ends
constexpr int kMostShifts = 50;

constexpr double cells_within(int reach) { return (2 * reach + 1) * (2 * reach + 1); }
/// Of the distances from the middle of the cells in a square ring.
constexpr double mean_square(int from, int to) {
  return (cells_within(to) * to * (to + 1) - cells_within(from) * from * (from + 1)) * 2 / 3 /
         (cells_within(to) - (from < 0 ? 0 : cells_within(from)));
}

/// How a value at the box follows from its means over the inner and the outer ring, as if it fell with the square of
/// the distance: points that meet by chance have small disparities rather than large ones.
constexpr double kAhead = (mean_square(kInner, kMiddle) - mean_square(-1, kBox)) /
                          (mean_square(kMiddle, kOuter) - mean_square(kInner, kMiddle));

/// Whether all votes for a cell are within the map.
bool whole(int column, int row) {
  constexpr int kMiddleCell = (kSide - 1) / 2, kRadius = kMiddleCell - 1;
  const int x = column - kMiddleCell, y = row - kMiddleCell;
  return x * x + y * y <= kRadius * kRadius;
}

/// Sums over squares of whole cells in constant time.
class CellSums {
 public:
  explicit CellSums(const std::vector<float>& cells) : sums_(static_cast<std::size_t>((kSide + 1) * (kSide + 1))) {
    for (int row = 0; row < kSide; ++row)
      for (int column = 0; column < kSide; ++column)
        for (std::size_t k = 0; k < 2; ++k) {
          const double own = k == 1 ? 1 : static_cast<double>(cells[static_cast<std::size_t>(row * kSide + column)]);
          at(row + 1, column + 1)[k] =
              (whole(column, row) ? own : 0) + at(row, column + 1)[k] + at(row + 1, column)[k] - at(row, column)[k];
        }
  }

  /// Votes within `reach` cells of (column, row), and how many whole cells there are.
  std::array<double, 2> around(int column, int row, int reach) {
    const int left = std::max(column - reach, 0), right = std::min(column + reach + 1, kSide);
    const int top = std::max(row - reach, 0), bottom = std::min(row + reach + 1, kSide);
    std::array<double, 2> sum{};
    for (std::size_t k = 0; k < 2; ++k)
      sum[k] = at(bottom, right)[k] - at(top, right)[k] - at(bottom, left)[k] + at(top, left)[k];
    return sum;
  }

  /// Votes in a cell of the box by those in two rings around.
  double background(int column, int row) {
    const auto inner = around(column, row, kInner), middle = around(column, row, kMiddle);
    const auto outer = around(column, row, kOuter);
    const double near = (middle[0] - inner[0]) / (middle[1] - inner[1]);
    const double far = (outer[0] - middle[0]) / (outer[1] - middle[1]);
    return std::max({0.0, near, near + kAhead * (near - far)});
  }

 private:
  std::array<double, 2>& at(int row, int column) { return sums_[static_cast<std::size_t>(row * (kSide + 1) + column)]; }
  std::vector<std::array<double, 2>> sums_;
};

/// Votes of a cell that are none of the spot's: a plane.
struct Background {
  double column0 = 0, row0 = 0, level = 0, per_column = 0, per_row = 0;
  double slope_variance = 0;  ///< of per_column, and of per_row
  double at(double column, double row) const {
    return std::max(0.0, level + per_column * (column - column0) + per_row * (row - row0));
  }
};

/// Calls visit(column, row, votes) for the whole cells within `reach` of a place.
template <class Visit>
void visit_around(const std::vector<float>& cells, int column, int row, int reach, Visit visit) {
  for (int r = std::max(row - reach, 0); r <= std::min(row + reach, kSide - 1); ++r)
    for (int c = std::max(column - reach, 0); c <= std::min(column + reach, kSide - 1); ++c)
      if (whole(c, r)) visit(c, r, static_cast<double>(cells[static_cast<std::size_t>(r * kSide + c)]));
}

/// Slopes by least squares over a square ring, each by itself, and their variance if votes are Poisson's.
struct Slope {
  double per_column = 0, per_row = 0, variance = 0;
};

Slope slope(const std::vector<float>& cells, int column, int row, int from, int to) {
  double n = 0, x = 0, y = 0, v = 0, xx = 0, yy = 0, xv = 0, yv = 0;
  visit_around(cells, column, row, to, [&](int c, int r, double votes) {
    const double right = c - column, below = r - row;
    if (std::max(std::abs(right), std::abs(below)) <= from) return;
    ++n, x += right, y += below, v += votes;
    xx += right * right, yy += below * below, xv += right * votes, yv += below * votes;
  });
  const double square_x = xx - x * x / n, square_y = yy - y * y / n;
  return {(xv - x * v / n) / square_x, (yv - y * v / n) / square_y, v / n / std::min(square_x, square_y)};
}

Background background_at(const std::vector<float>& cells, int column, int row, double level) {
  const Slope near = slope(cells, column, row, kInner, kMiddle), far = slope(cells, column, row, kMiddle, kOuter);
  const auto at_box = [](double near_one, double far_one) { return near_one + kAhead * (near_one - far_one); };
  return {static_cast<double>(column),
          static_cast<double>(row),
          level,
          at_box(near.per_column, far.per_column),
          at_box(near.per_row, far.per_row),
          (1 + kAhead) * (1 + kAhead) * near.variance + kAhead * kAhead * far.variance};
}

/// Moments of the votes, less the background's, under a Gaussian window round (column, row); all in cells.
struct Window {
  double mass = 0, column = 0, row = 0;
  double curvature = 0;  ///< how fast the shift returns to the spot, times mass
  double variance = 0;   ///< Poisson's, of the shift of either coordinate, times mass²
  double per_slope = 0;  ///< shift by a slope of the background that is not taken off, times mass
};

Window look(const std::vector<float>& cells, double column, double row, const Background& background) {
  Window sum;
  const auto add = [&](int c, int r, double votes) {
    const double x = c - column, y = r - row, square = x * x + y * y;
    const double weight = std::exp(-square / (2 * kWindowCells * kWindowCells));
    const double own = weight * (votes - background.at(c, r));
    sum.mass += own, sum.column += own * x, sum.row += own * y;
    sum.curvature += own * (1 - square / (2 * kWindowCells * kWindowCells));
    sum.variance += weight * weight * votes * square / 2;
    sum.per_slope += weight * square / 2;
  };
  visit_around(cells, static_cast<int>(std::lround(column)), static_cast<int>(std::lround(row)), kReachCells, add);
  return sum;
}

}  // namespace

DisparityMap::DisparityMap(double radius_px)
    : radius_px_(radius_px), cells_(static_cast<std::size_t>(kCells * kCells)) {
  if (!(radius_px > 0 && std::isfinite(radius_px)))
    throw Error(ExitCode::usage, fmt::format("a disparity map of {} px has no room; give some pixels", radius_px));
}

bool DisparityMap::add(const Pixel& disparity_px) noexcept {
  const double column = disparity_px[0] / cell_px() + (kCells - 1) / 2,
               row = disparity_px[1] / cell_px() + (kCells - 1) / 2;
  if (!(std::hypot(disparity_px[0], disparity_px[1]) <= radius_px_)) {
    ++outside_;
    return false;
  }
  const int c = std::min(static_cast<int>(column), kCells - 2), r = std::min(static_cast<int>(row), kCells - 2);
  const auto right = static_cast<float>(column - c), below = static_cast<float>(row - r);
  float* cell = cells_.data() + r * kCells + c;
  cell[0] += (1 - right) * (1 - below), cell[1] += right * (1 - below);
  cell[kCells] += (1 - right) * below, cell[kCells + 1] += right * below;
  ++votes_;
  return true;
}

void DisparityMap::clear() noexcept { fade(0); }

void DisparityMap::fade(double factor) noexcept {
  for (float& cell : cells_) cell *= static_cast<float>(factor);
  votes_ *= factor, outside_ *= factor;
}

std::optional<DisparityPeak> DisparityMap::peak() const {
  CellSums sums(cells_);
  double surest = 0, level = 0;
  int column0 = 0, row0 = 0;
  for (int r = 0; r < kCells; ++r)
    for (int c = 0; c < kCells; ++c) {
      if (!whole(c, r)) continue;
      const auto [votes, area] = sums.around(c, r, kBox);
      const double around = sums.background(c, r);
      const double sure = (votes - around * area) / std::sqrt(std::max(votes + around * area, 1.0));
      if (sure > surest) surest = sure, column0 = c, row0 = r, level = around;
    }
  if (surest < kSurest) return {};
  const Background background = background_at(cells_, column0, row0, level);
  double column = column0, row = row0;
  Window window;
  for (int step = 0; step < kMostShifts; ++step) {
    window = look(cells_, column, row, background);
    if (!(window.mass > 0)) return {};
    const double right = window.column / window.mass, below = window.row / window.mass;
    column = std::clamp(column + right, 0.0, kCells - 1.0), row = std::clamp(row + below, 0.0, kCells - 1.0);
    if (std::hypot(right, below) < 1e-6) break;
  }
  if (!(window.curvature > 0)) return {};  // no spot: the window is full of votes to its end
  const auto [votes, area] =
      sums.around(static_cast<int>(std::lround(column)), static_cast<int>(std::lround(row)), kInner);
  DisparityPeak peak;
  peak.at_px = {(column - (kCells - 1) / 2) * cell_px(), (row - (kCells - 1) / 2) * cell_px()};
  const double variance = window.variance + background.slope_variance * window.per_slope * window.per_slope;
  peak.sigma_px = cell_px() * std::sqrt(variance) / window.curvature;
  peak.votes = votes - background.at(column, row) * area;
  return peak;
}

}  // namespace rptv
