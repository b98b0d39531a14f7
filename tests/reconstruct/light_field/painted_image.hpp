// SPDX-License-Identifier: MIT
// Ideal light-field images of points: a pixel is lit when its ray passes a particle within the lenslet's cell.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "calibration/light_field/lenslet_lattice.hpp"
#include "core/image.hpp"

namespace rptv::testing {

/// A small camera whose figures are those of the ray-traced wall set.
inline LightFieldCalibration small_camera(std::int64_t width_px = 512, std::int64_t height_px = 384) {
  LightFieldCalibration c;
  c.sensor = {width_px, height_px, 9.0, {}};
  c.lenslets.pitch_um = 125, c.lenslets.focal_length_mm = 3.75;
  c.lenslets.rotation_deg = 0.19, c.lenslets.offset_um = {-22.2, 28.7};
  c.lens.model = "thick_lens", c.lens.exit_pupil_mm = 84.82, c.lens.image_f_number = 32.3;
  c.lens.focal_length_mm = 25, c.lens.array_distance_mm = 87.5;
  return c;
}

struct ImageParticle {
  double x, y, z;  ///< image space, mm
};

class PaintedImage {
 public:
  explicit PaintedImage(const LightFieldCalibration& calibration)
      : calibration_(calibration),
        lattice_(calibration),
        shape_{static_cast<std::uint32_t>(calibration.sensor.width_px),
               static_cast<std::uint32_t>(calibration.sensor.height_px), 2},
        pixels_(shape_.pixels()) {}

  /// Lights the pixels of a particle of the given radius (mm, image space) and returns how many.
  int paint(const ImageParticle& p, double radius_mm, std::uint16_t grey = 200) {
    int lit = 0;
    const double f = calibration_.lenslets.focal_length_mm, half = calibration_.pitch_mm() / 2 + radius_mm;
    const double cone = 0.5 / calibration_.lens.image_f_number, pupil = calibration_.lens.exit_pupil_mm;
    const auto axis = calibration_.optical_axis_px();
    // Pixels that can see it: round where the chief ray lands, generously.
    const double shrink = (1 - p.z / pupil) / calibration_.apparent_scale(), pixel_mm = calibration_.pixel_mm();
    const double reach_px = ((half + cone * std::abs(p.z)) * 1.5 / shrink + calibration_.pitch_mm()) * 2 / pixel_mm;
    const double middle_x = p.x / shrink / pixel_mm + axis[0], middle_y = p.y / shrink / pixel_mm + axis[1];
    const auto px = [](double at) { return static_cast<std::uint32_t>(std::max(0.0, at)); };
    for (auto row = px(middle_y - reach_px); row < std::min(px(middle_y + reach_px), shape_.height_px); ++row)
      for (auto column = px(middle_x - reach_px); column < std::min(px(middle_x + reach_px), shape_.width_px);
           ++column) {
        const double x = (column - axis[0]) * calibration_.pixel_mm(), y = (row - axis[1]) * calibration_.pixel_mm();
        std::array<std::uint32_t, 1> lenslet{};
        lattice_.lenslets_of(x, y, lenslet);
        const auto centre = lattice_.centre_mm(lenslet[0]);
        const double sx = (centre[0] - x) / f, sy = (centre[1] - y) / f;
        // The ray of this slope that meets the particle must come through the pupil and through this cell.
        if (std::hypot(p.x + sx * (pupil - p.z), p.y + sy * (pupil - p.z)) > cone * pupil) continue;
        const double dx = p.x - sx * p.z - centre[0], dy = p.y - sy * p.z - centre[1];
        const double c = lattice_.rotation_cosine(), s = lattice_.rotation_sine();
        if (std::abs(c * dx + s * dy) > half || std::abs(c * dy - s * dx) > half) continue;
        pixels_[std::size_t{row} * shape_.width_px + column] = grey;
        ++lit;
      }
    return lit;
  }
  void fill(std::uint16_t grey) { std::fill(pixels_.begin(), pixels_.end(), grey); }
  std::vector<std::uint16_t>& pixels() noexcept { return pixels_; }
  ImageView view() const noexcept { return {reinterpret_cast<const std::byte*>(pixels_.data()), shape_}; }

 private:
  LightFieldCalibration calibration_;
  LensletLattice lattice_;
  ImageShape shape_;
  std::vector<std::uint16_t> pixels_;
};

/// Particles whose rays stay on the sensor, at least `apart_mm` from each other on the array plane.
inline std::vector<ImageParticle> scatter(int count, double half_x, double half_y, double low_z, double high_z,
                                          double apart_mm, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<ImageParticle> all;
  for (int trial = 0; trial < 100000 && static_cast<int>(all.size()) < count; ++trial) {
    const ImageParticle p{half_x * unit(random), half_y * unit(random),
                          low_z + (high_z - low_z) * (0.5 + 0.5 * unit(random))};
    bool free = true;
    for (const auto& other : all) free = free && std::hypot(p.x - other.x, p.y - other.y) > apart_mm;
    if (free) all.push_back(p);
  }
  return all;
}

}  // namespace rptv::testing
