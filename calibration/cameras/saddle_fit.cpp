// SPDX-License-Identifier: MIT
// Gauss-Newton on the grey values round a corner.
#include "calibration/cameras/saddle_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace rptv {

namespace {

constexpr int kUnknowns = 9;  // level, slope x, slope y, contrast, centre x, centre y, angle 1, angle 2, blur
constexpr int kMostSaddleSteps = 25;
constexpr double kSettled_px = 1e-4;
constexpr double kMostShift_px = 3, kLeastBlur_px = 0.25, kMostBlur_px = 8;
constexpr double kLeastCrossing = 0.2;  // sine of the angle between the edges
constexpr double kWorstSigma_px = 0.25;
constexpr double kFlat_sigmas = 4;  // beyond, an edge has no slope left

using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;
using Square = Eigen::Matrix<double, kUnknowns, kUnknowns>;

struct Sums {
  Square square = Square::Zero();
  Unknowns vector = Unknowns::Zero();
  double residual = 0;
  int count = 0;
};

double edge(double z) { return std::abs(z) > kFlat_sigmas ? std::copysign(1.0, z) : std::erf(z / std::numbers::sqrt2); }
double edge_slope(double z) {
  return std::abs(z) > kFlat_sigmas ? 0 : std::sqrt(2 / std::numbers::pi) * std::exp(-0.5 * z * z);
}

/// Over a disc that stays where it is: one that followed the centre would gain and lose pixels at every step, for ever.
Sums sums_of(const GreyImage& image, const std::vector<std::uint8_t>& hidden, const Pixel& middle, double radius_px,
             const Unknowns& u) {
  Sums sums;
  const double x0 = u[4], y0 = u[5], blur = u[8];
  const double n1x = -std::sin(u[6]), n1y = std::cos(u[6]), n2x = -std::sin(u[7]), n2y = std::cos(u[7]);
  const int left = std::max(0, static_cast<int>(std::ceil(middle[0] - radius_px)));
  const int right = std::min(image.width - 1, static_cast<int>(std::floor(middle[0] + radius_px)));
  const int top = std::max(0, static_cast<int>(std::ceil(middle[1] - radius_px)));
  const int bottom = std::min(image.height - 1, static_cast<int>(std::floor(middle[1] + radius_px)));
  Unknowns row;
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      const double dx = x - x0, dy = y - y0;
      if (std::hypot(x - middle[0], y - middle[1]) > radius_px) continue;
      if (hidden[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] !=
          0)
        continue;
      const double z1 = (n1x * dx + n1y * dy) / blur, z2 = (n2x * dx + n2y * dy) / blur;
      const double e1 = edge(z1), e2 = edge(z2), s1 = edge_slope(z1) * e2, s2 = edge_slope(z2) * e1;
      // An edge's distance falls by its normal when the centre moves, and by the way along it when the edge turns.
      const double along1 = n1y * dx - n1x * dy, along2 = n2y * dx - n2x * dy, scale = u[3] / blur;
      row << 1, dx, dy, e1 * e2, -u[1] - scale * (s1 * n1x + s2 * n2x), -u[2] - scale * (s1 * n1y + s2 * n2y),
          -scale * s1 * along1, -scale * s2 * along2, -scale * (s1 * z1 + s2 * z2);
      const double left_over = image.at(x, y) - (u[0] + u[1] * dx + u[2] * dy + u[3] * e1 * e2);
      sums.square.selfadjointView<Eigen::Lower>().rankUpdate(row);
      sums.vector += left_over * row;
      sums.residual += left_over * left_over;
      ++sums.count;
    }
  return sums;
}

}  // namespace

std::optional<SaddleFit> fit_saddle(const GreyImage& image, const std::vector<std::uint8_t>& hidden,
                                    const Saddle& start, double radius_px) {
  Unknowns u;
  u << start.level, 0, 0, start.contrast, start.centre[0], start.centre[1], start.angle_1, start.angle_2, start.blur_px;
  for (int step = 0; step < kMostSaddleSteps; ++step) {
    const Sums sums = sums_of(image, hidden, start.centre, radius_px, u);
    if (sums.count < 4 * kUnknowns) return std::nullopt;
    const Eigen::LDLT<Square, Eigen::Lower> factors(sums.square);
    Unknowns change;
    if (step == 0) {  // without a contrast the rest has no derivatives: the grey values alone, first
      change.setZero();
      change.head<4>() =
          sums.square.topLeftCorner<4, 4>().selfadjointView<Eigen::Lower>().llt().solve(sums.vector.head<4>());
    } else {
      change = factors.solve(sums.vector);
    }
    if (!change.allFinite()) return std::nullopt;
    u += change;
    u[8] = std::clamp(u[8], kLeastBlur_px, kMostBlur_px);
    if (std::hypot(u[4] - start.centre[0], u[5] - start.centre[1]) > kMostShift_px ||
        std::abs(std::sin(u[6] - u[7])) < kLeastCrossing)
      return std::nullopt;
    if (step == 0 || std::hypot(change[4], change[5]) > kSettled_px) continue;
    const Square inverse = factors.solve(Square::Identity());
    const double variance = sums.residual / (sums.count - kUnknowns);
    const double sigma = std::sqrt(0.5 * variance * (inverse(4, 4) + inverse(5, 5)));
    if (!(sigma < kWorstSigma_px)) return std::nullopt;
    return SaddleFit{{{u[4], u[5]}, u[6], u[7], u[8], u[0], u[3]}, sigma};
  }
  return std::nullopt;
}

}  // namespace rptv
