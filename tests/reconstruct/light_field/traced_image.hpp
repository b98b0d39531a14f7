// SPDX-License-Identifier: MIT
// Images made photon by photon, by other means than the forward model: an ideal lens, pinhole lenslets, diffraction.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/reconstruct/light_field/painted_image.hpp"

namespace rptv::testing {

class TracedImage {
 public:
  TracedImage(const LightFieldCalibration& calibration, unsigned seed)
      : calibration_(calibration),
        lattice_(calibration),
        shape_{static_cast<std::uint32_t>(calibration.sensor.width_px),
               static_cast<std::uint32_t>(calibration.sensor.height_px), 2},
        photons_(shape_.pixels()),
        random_(seed) {}

  /// A uniform disc of the given radius that fills the pupil evenly; `first_zero_um`: of sinc² along both axes.
  void add(const ImageParticle& p, double radius_mm, int photons, double first_zero_um = 0) {
    const double pupil_mm = calibration_.lens.exit_pupil_mm, pixel_mm = calibration_.pixel_mm();
    const auto axis = calibration_.optical_axis_px();
    for (int i = 0; i < photons; ++i) {
      const auto [body_x, body_y] = in_disc(radius_mm);
      const bool finite = pupil_mm > 0;
      const auto [pupil_x, pupil_y] = in_disc(0.5 / calibration_.lens.image_f_number * (finite ? pupil_mm : 1));
      const double x = p.x + body_x, y = p.y + body_y;
      const double s_x = finite ? (pupil_x - x) / (pupil_mm - p.z) : pupil_x;
      const double s_y = finite ? (pupil_y - y) / (pupil_mm - p.z) : pupil_y;
      const auto [u, v] = lattice_.on_true_lattice(x - s_x * p.z, y - s_y * p.z);
      const long column = std::lround(u), row = std::lround(v);
      if (column < 0 || row < 0 || column >= lattice_.columns() || row >= lattice_.rows()) continue;
      const auto centre = lattice_.centre_mm(static_cast<std::uint32_t>(row * lattice_.columns() + column));
      const double f = calibration_.lenslets.focal_length_mm;
      put((centre[0] - f * s_x + scatter(first_zero_um)) / pixel_mm + axis[0],
          (centre[1] - f * s_y + scatter(first_zero_um)) / pixel_mm + axis[1]);
    }
  }
  /// Grey values: photons over gain, with read noise, rounded; 0 is the black level.
  std::vector<std::uint16_t> expose(double electrons_per_grey, double read_noise_grey) {
    std::normal_distribution<double> noise(0, read_noise_grey > 0 ? read_noise_grey : 1);
    std::vector<std::uint16_t> grey;
    for (const int n : photons_)
      grey.push_back(static_cast<std::uint16_t>(
          std::max(0.0, std::round(kBlack + n / electrons_per_grey + (read_noise_grey > 0 ? noise(random_) : 0)))));
    return grey;
  }
  ImageShape shape() const noexcept { return shape_; }
  const std::vector<int>& photons() const noexcept { return photons_; }

  static constexpr double kBlack = 20;

 private:
  std::array<double, 2> in_disc(double radius) {
    const double r = radius * std::sqrt(unit_(random_)), angle = 2 * std::numbers::pi * unit_(random_);
    return {r * std::cos(angle), r * std::sin(angle)};
  }
  // sinc² by rejection under min(1, 1/(πt)²).
  double scatter(double first_zero_um) {
    if (!(first_zero_um > 0)) return 0;
    while (true) {
      double angle = unit_(random_);  // πt; both parts of the bound, below 1 and above, have the same area
      if (unit_(random_) > 0.5) angle = 1 / std::max(angle, 1e-9);
      const double bound = angle < 1 ? 1 : 1 / (angle * angle);
      const double value = angle < 1e-6 ? 1 : std::pow(std::sin(angle) / angle, 2);
      if (unit_(random_) * bound > value) continue;
      return (unit_(random_) < 0.5 ? -1 : 1) * angle / std::numbers::pi * first_zero_um * 1e-3;
    }
  }
  void put(double column, double row) {
    const long i = std::lround(column), j = std::lround(row);
    if (i >= 0 && j >= 0 && i < calibration_.sensor.width_px && j < calibration_.sensor.height_px)
      ++photons_[static_cast<std::size_t>(j) * shape_.width_px + static_cast<std::size_t>(i)];
  }

  LightFieldCalibration calibration_;
  LensletLattice lattice_;
  ImageShape shape_;
  std::vector<int> photons_;
  std::mt19937 random_;
  std::uniform_real_distribution<double> unit_{0, 1};
};

}  // namespace rptv::testing
