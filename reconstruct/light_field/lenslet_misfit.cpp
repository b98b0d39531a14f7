// SPDX-License-Identifier: MIT
// One sum of pulls a lenslet, each judged by its own normal matrix.
#include "reconstruct/light_field/lenslet_misfit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace rptv {

namespace {

constexpr double kLeastKnown = 0.01;  // eigenvalue of a lenslet's matrix, the whole having a unit diagonal
constexpr double kNoiseSigmas = 2;    // of Q: that much may be noise

using Matrix = Eigen::Matrix4d;

Matrix matrix_of(const std::array<double, 10>& upper) noexcept {
  Matrix m;
  for (int row = 0, k = 0; row < 4; ++row)
    for (int column = row; column < 4; ++column, ++k)
      m(row, column) = m(column, row) = upper[static_cast<std::size_t>(k)];
  return m;
}

}  // namespace

LensletMisfit::LensletMisfit(const LightFieldCalibration& calibration, const LensletLattice& lattice)
    : lattice_(lattice),
      width_px_(static_cast<std::uint32_t>(calibration.sensor.width_px)),
      pixel_mm_(calibration.pixel_mm()),
      axis_px_(calibration.optical_axis_px()),
      pulls_(kMostLenslets) {}

LensletMisfit::Pull& LensletMisfit::pull_of(std::uint32_t pixel) noexcept {
  const auto [u, v] = lattice_.on_apparent_lattice((pixel % width_px_ - axis_px_[0]) * pixel_mm_,
                                                   (pixel / width_px_ - axis_px_[1]) * pixel_mm_);
  const auto column = static_cast<std::int32_t>(std::lround(u)), row = static_cast<std::int32_t>(std::lround(v));
  const auto is_its = [&](const Pull& p) { return p.column == column && p.row == row; };
  if (count_ > 0 && is_its(pulls_[last_])) return pulls_[last_];
  const auto end = pulls_.begin() + static_cast<std::ptrdiff_t>(count_);
  last_ = static_cast<std::size_t>(std::find_if(pulls_.begin(), end, is_its) - pulls_.begin());
  if (last_ == count_ && count_ < kMostLenslets) pulls_[count_++] = {column, row, {}, {}};
  last_ = std::min(last_, count_ - 1);
  return pulls_[last_];
}

double LensletMisfit::operator()(const ParticleImage& image, const Seen& seen, double light) noexcept {
  count_ = 0;
  Eigen::Vector4d whole = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < image.size; ++i) {
    const auto value = static_cast<double>(image.value[i]), expected = light * value;
    const auto others = static_cast<double>(seen.others[i]), off = static_cast<double>(seen.misfit) * others;
    const double weight = 1 / (static_cast<double>(seen.dark_variance) + off * off +
                               static_cast<double>(seen.variance_per_grey) * std::max(others + expected, 0.0));
    const std::array<double, 4> slope{light * static_cast<double>(image.dx[i]),
                                      light * static_cast<double>(image.dy[i]),
                                      light * static_cast<double>(image.dz[i]), value};
    const double rest = weight * (static_cast<double>(seen.grey[i]) - expected);
    auto& p = pull_of(image.pixel[i]);
    for (std::size_t row = 0, k = 0; row < 4; ++row) {
      p.pull[row] += rest * slope[row];
      for (std::size_t column = row; column < 4; ++column, ++k) p.normal[k] += weight * slope[row] * slope[column];
      whole[static_cast<Eigen::Index>(row)] += weight * slope[row] * slope[row];
    }
  }
  if (count_ < 2 || !(whole.array() > 0).all()) return 1;
  const Eigen::Vector4d scale = whole.array().rsqrt();
  double q = 0, freedom = -4;
  for (std::size_t l = 0; l < count_; ++l) {
    const Matrix normal = scale.asDiagonal() * matrix_of(pulls_[l].normal) * scale.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Matrix> solver(normal);
    const Eigen::Vector4d along = solver.eigenvectors().transpose() *
                                  (scale.array() * Eigen::Map<const Eigen::Array4d>(pulls_[l].pull.data())).matrix();
    for (Eigen::Index k = 0; k < 4; ++k) {
      const double known = std::max(solver.eigenvalues()[k], 0.0);
      q += along[k] * along[k] / (known + kLeastKnown);
      freedom += known / (known + kLeastKnown);
    }
  }
  if (!(freedom >= 1)) return 1;
  return std::max(1.0, (q - kNoiseSigmas * std::sqrt(2 * freedom)) / freedom);
}

}  // namespace rptv
