// SPDX-License-Identifier: MIT
// The true and the apparent lattice of a microlens array.
#include "calibration/lenslet_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace rptv {

namespace {
constexpr double kMostLenslets = 1e7;
}

LensletLattice::LensletLattice(const LightFieldCalibration& calibration)
    : pitch_mm_(calibration.pitch_mm()),
      scale_(calibration.apparent_scale()),
      cosine_(std::cos(calibration.lenslets.rotation_deg * std::numbers::pi / 180)),
      sine_(std::sin(calibration.lenslets.rotation_deg * std::numbers::pi / 180)),
      first_x_mm_(calibration.lenslets.offset_um.at(0) * 1e-3),
      first_y_mm_(calibration.lenslets.offset_um.at(1) * 1e-3),
      subimage_radius_mm_(calibration.lens.image_f_number > 0
                              ? 0.5 * calibration.lenslets.focal_length_mm / calibration.lens.image_f_number +
                                    std::numbers::sqrt2 / 2 * calibration.pixel_mm()
                              : 0) {
  cover_sensor(calibration);
}

void LensletLattice::cover_sensor(const LightFieldCalibration& calibration) {
  const auto axis = calibration.optical_axis_px();
  double low_u = 1e300, high_u = -1e300, low_v = 1e300, high_v = -1e300;
  for (const double i : {-0.5, static_cast<double>(calibration.sensor.width_px) - 0.5})
    for (const double j : {-0.5, static_cast<double>(calibration.sensor.height_px) - 0.5}) {
      const auto [u, v] =
          on_apparent_lattice((i - axis[0]) * calibration.pixel_mm(), (j - axis[1]) * calibration.pixel_mm());
      low_u = std::min(low_u, u), high_u = std::max(high_u, u);
      low_v = std::min(low_v, v), high_v = std::max(high_v, v);
    }
  const double reach = std::ceil(subimage_radius_mm_ / (pitch_mm_ * scale_)) + 1;
  const double first_u = std::floor(low_u) - reach, first_v = std::floor(low_v) - reach;
  const double columns = std::ceil(high_u) + reach - first_u + 1, rows = std::ceil(high_v) + reach - first_v + 1;
  if (!(columns * rows <= kMostLenslets))
    throw Error(ExitCode::configuration,
                "the calibration describes more than 10 million lenslets on the sensor; check "
                "lenslets.pitch_um, sensor.pixel_um and lens.image_f_number");
  const auto first = centre_of(first_u, first_v);
  first_x_mm_ = first[0], first_y_mm_ = first[1];
  columns_ = static_cast<std::uint32_t>(columns), rows_ = static_cast<std::uint32_t>(rows);
  centres_.reserve(size());
  for (std::uint32_t v = 0; v < rows_; ++v)
    for (std::uint32_t u = 0; u < columns_; ++u) {
      const auto [x, y] = centre_of(u, v);
      centres_.push_back({static_cast<float>(x), static_cast<float>(y)});
    }
}

std::array<double, 2> LensletLattice::centre_of(double column, double row) const noexcept {
  return {first_x_mm_ + pitch_mm_ * (cosine_ * column - sine_ * row),
          first_y_mm_ + pitch_mm_ * (sine_ * column + cosine_ * row)};
}

std::array<double, 2> LensletLattice::spot_mm(std::uint32_t index) const noexcept {
  const auto [x, y] = centre_of(index % columns_, index / columns_);
  return {x * scale_, y * scale_};
}

std::array<double, 2> LensletLattice::on_true_lattice(double x_mm, double y_mm) const noexcept {
  const double x = (x_mm - first_x_mm_) / pitch_mm_, y = (y_mm - first_y_mm_) / pitch_mm_;
  return {cosine_ * x + sine_ * y, cosine_ * y - sine_ * x};
}

void LensletLattice::lenslets_of(double x_mm, double y_mm, std::span<std::uint32_t> hypotheses) const noexcept {
  std::fill(hypotheses.begin(), hypotheses.end(), kNone);
  const auto [u, v] = on_apparent_lattice(x_mm, y_mm);
  const auto nearest_u = static_cast<std::int64_t>(std::lround(u)),
             nearest_v = static_cast<std::int64_t>(std::lround(v));
  if (hypotheses.size() == 1) {
    if (nearest_u >= 0 && nearest_v >= 0 && nearest_u < columns_ && nearest_v < rows_)
      hypotheses[0] = static_cast<std::uint32_t>(nearest_v * columns_ + nearest_u);
    return;
  }
  constexpr std::size_t kMost = 64;
  struct Near {
    double distance2;
    std::uint32_t index;
  };
  std::array<Near, kMost> found{};
  std::size_t count = 0;
  const double radius = subimage_radius_mm_ > 0 ? subimage_radius_mm_ / (pitch_mm_ * scale_) : 1e300;
  constexpr std::int64_t kReach = 3;
  for (std::int64_t row = nearest_v - kReach; row <= nearest_v + kReach; ++row)
    for (std::int64_t column = nearest_u - kReach; column <= nearest_u + kReach; ++column) {
      if (column < 0 || row < 0 || column >= columns_ || row >= rows_) continue;
      const double du = static_cast<double>(column) - u, dv = static_cast<double>(row) - v;
      if (du * du + dv * dv <= radius * radius && count < kMost)
        found[count++] = {du * du + dv * dv, static_cast<std::uint32_t>(row * columns_ + column)};
    }
  std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Near& a, const Near& b) { return a.distance2 < b.distance2; });
  for (std::size_t k = 0; k < std::min(count, hypotheses.size()); ++k) hypotheses[k] = found[k].index;
}

}  // namespace rptv
