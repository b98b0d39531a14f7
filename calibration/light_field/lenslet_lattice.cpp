// SPDX-License-Identifier: MIT
// The true and the apparent lattice of a microlens array.
#include "calibration/light_field/lenslet_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.hpp"

namespace rptv {

namespace {
constexpr double kMostLenslets = 1e7;
}

LensletLattice::LensletLattice(const LightFieldCalibration& calibration)
    : geometry_(calibration.true_lattice()),
      scale_(calibration.apparent_scale()),
      subimage_radius_mm_(calibration.lens.image_f_number > 0
                              ? 0.5 * calibration.lenslets.focal_length_mm / calibration.lens.image_f_number +
                                    std::numbers::sqrt2 / 2 * calibration.pixel_mm()
                              : 0) {
  cover_sensor(calibration);
}

void LensletLattice::cover_sensor(const LightFieldCalibration& calibration) {
  const auto axis = calibration.optical_axis_px();
  const auto width = static_cast<double>(calibration.sensor.width_px);
  const auto height = static_cast<double>(calibration.sensor.height_px);
  double low_u = 1e300, high_u = -1e300, low_v = 1e300, high_v = -1e300;
  constexpr int kSteps = 8;  // a distorted border's extremes need not be at its corners
  for (int a = 0; a <= kSteps; ++a)
    for (int b = 0; b <= kSteps; ++b) {
      const double i = width * a / kSteps - 0.5, j = height * b / kSteps - 0.5;
      const auto [u, v] =
          on_apparent_lattice((i - axis[0]) * calibration.pixel_mm(), (j - axis[1]) * calibration.pixel_mm());
      low_u = std::min(low_u, u), high_u = std::max(high_u, u);
      low_v = std::min(low_v, v), high_v = std::max(high_v, v);
    }
  const double reach = std::ceil(subimage_radius_mm_ / (pitch_mm() * scale_)) + 1;
  first_u_ = std::floor(low_u) - reach, first_v_ = std::floor(low_v) - reach;
  const double columns = std::ceil(high_u) + reach - first_u_ + 1, rows = std::ceil(high_v) + reach - first_v_ + 1;
  if (!(columns * rows <= kMostLenslets))
    throw Error(ExitCode::configuration,
                "the calibration describes more than 10 million lenslets on the sensor; check "
                "lenslets.pitch_um, sensor.pixel_um and lens.image_f_number");
  columns_ = static_cast<std::uint32_t>(columns), rows_ = static_cast<std::uint32_t>(rows);
  centres_.reserve(size());
  const LensletMask& mask = calibration.arrays.ray;
  const auto& light = calibration.arrays.vignetting;
  const auto& area = calibration.arrays.area;
  if (!mask.empty()) masked_.reserve(size());
  if (!light.empty()) brightness_.reserve(size());
  for (std::uint32_t v = 0; v < rows_; ++v)
    for (std::uint32_t u = 0; u < columns_; ++u) {
      const auto [x, y] = geometry_.position_mm(first_u_ + u, first_v_ + v);
      centres_.push_back({static_cast<float>(x), static_cast<float>(y)});
      const auto iu = static_cast<std::int64_t>(first_u_) + u, iv = static_cast<std::int64_t>(first_v_) + v;
      if (!mask.empty()) masked_.push_back(mask.of(iu, iv));
      if (light.empty()) continue;
      const bool known = mask.has(iu, iv);
      const float share = known && !area.empty() ? area[mask.place(iu, iv)] : 0;
      brightness_.push_back(known ? light[mask.place(iu, iv)] / (share > 0 ? share : 1.0F) : 0);
    }
}

std::array<double, 2> LensletLattice::spot_mm(std::uint32_t index) const noexcept {
  const auto [x, y] = geometry_.position_mm(first_u_ + index % columns_, first_v_ + index / columns_);
  return {x * scale_, y * scale_};
}

std::array<double, 2> LensletLattice::on_true_lattice(double x_mm, double y_mm) const noexcept {
  const auto [u, v] = geometry_.lattice_of(x_mm, y_mm);
  return {u - first_u_, v - first_v_};
}

void LensletLattice::lenslets_of(double x_mm, double y_mm, std::span<std::uint32_t> hypotheses) const noexcept {
  std::fill(hypotheses.begin(), hypotheses.end(), kNone);
  const auto near = geometry_.nearest_of(x_mm / scale_, y_mm / scale_);
  const auto nearest_u = static_cast<std::int64_t>(near[0] - first_u_),
             nearest_v = static_cast<std::int64_t>(near[1] - first_v_);
  const auto index_of = [&](std::int64_t u, std::int64_t v) {
    if (u < 0 || v < 0 || u >= columns_ || v >= rows_) return kNone;
    const auto index = static_cast<std::uint32_t>(v * columns_ + u);
    return masked(index) == 0 ? index : kNone;
  };
  if (hypotheses.size() == 1) {
    hypotheses[0] = index_of(nearest_u, nearest_v);
    return;
  }
  constexpr std::size_t kMost = 64;
  struct Near {
    double distance2;
    std::uint32_t index;
  };
  std::array<Near, kMost> found{};
  std::size_t count = 0;
  const auto [u, v] = on_apparent_lattice(x_mm, y_mm);
  const double radius = subimage_radius_mm_ > 0 ? subimage_radius_mm_ / (pitch_mm() * scale_) : 1e300;
  constexpr std::int64_t kReach = 3;
  for (std::int64_t row = nearest_v - kReach; row <= nearest_v + kReach; ++row)
    for (std::int64_t column = nearest_u - kReach; column <= nearest_u + kReach; ++column) {
      const auto index = index_of(column, row);
      const double distance2 = geometry_.distance2(static_cast<double>(column) - u, static_cast<double>(row) - v);
      if (index != kNone && distance2 <= radius * radius && count < kMost) found[count++] = {distance2, index};
    }
  std::sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count),
            [](const Near& a, const Near& b) { return a.distance2 < b.distance2; });
  for (std::size_t k = 0; k < std::min(count, hypotheses.size()); ++k) hypotheses[k] = found[k].index;
}

}  // namespace rptv
