// SPDX-License-Identifier: MIT
// White images drawn from a known lattice, as oracles: discs with soft edges, overlap, cat's eyes, shot and read noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "calibration/light_field/find_lenslets.hpp"
#include "calibration/light_field/sensor_frame.hpp"

namespace rptv::testing {

struct WhiteScene {
  LightFieldCalibration camera;  ///< the truth
  double radius_pitches = 0.4;   ///< of a sub-image
  double grey = 60;              ///< within a sub-image, at 4 electrons a grey value
  double read_noise = 0.5;       ///< grey values
  double clip_from_px = 1e9;     ///< beyond this from the axis a second rim cuts the pupil …
  double clip_per_px = 0.02;     ///< … and its image moves by this much per px
  unsigned seed = 1;
};

/// A camera of `width` x `height` px of 9 um, 125 um lenslets: about 14 px a pitch.
inline LightFieldCalibration white_camera(std::int64_t width = 480, std::int64_t height = 360) {
  LightFieldCalibration c;
  c.sensor = {width, height, 9.0, {}};
  c.lenslets.pitch_um = 125, c.lenslets.focal_length_mm = 3.75;
  c.lenslets.rotation_deg = 0.7, c.lenslets.offset_um = {-22.2, 28.7};
  c.lens.model = "thick_lens", c.lens.exit_pupil_mm = 84.82, c.lens.image_f_number = 32.3;
  c.lens.focal_length_mm = 25, c.lens.array_distance_mm = 87.5;
  return c;
}

/// The image, rounded to whole grey values; not saturated.
inline GreyImage draw_white(const WhiteScene& scene) {
  const auto& c = scene.camera;
  const LensletGeometry lattice(c.true_lattice());
  const SensorFrame frame(c);
  const double scale = c.apparent_scale(), radius = scene.radius_pitches * c.pitch_mm() * scale / c.pixel_mm();
  GreyImage image(static_cast<int>(c.sensor.width_px), static_cast<int>(c.sensor.height_px));
  std::mt19937 random(scene.seed);
  std::normal_distribution<double> normal;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      const auto at = frame.to_mm({static_cast<double>(column), static_cast<double>(row)});
      const auto near = lattice.nearest_of(at[0] / scale, at[1] / scale);
      double light = 0;
      for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du) {
          const auto p = lattice.position_mm(near[0] + du, near[1] + dv);
          const auto spot = frame.to_px({p[0] * scale, p[1] * scale});
          const double dx = column - spot[0], dy = row - spot[1];
          double inside = std::clamp(radius - std::hypot(dx, dy) + 0.5, 0.0, 1.0);
          const double far_x = spot[0] - frame.axis_px[0], far_y = spot[1] - frame.axis_px[1];
          if (const double far = std::hypot(far_x, far_y); far > scene.clip_from_px) {
            const double shift = scene.clip_per_px * (far - scene.clip_from_px);
            const double rim = std::hypot(dx + shift * far_x / far, dy + shift * far_y / far);
            inside = std::min(inside, std::clamp(radius - rim + 0.5, 0.0, 1.0));
          }
          light += inside;
        }
      const double electrons = 4 * scene.grey * light;
      const double grey = (electrons + std::sqrt(electrons) * normal(random)) / 4 + scene.read_noise * normal(random);
      image.at(column, row) = static_cast<float>(std::max(0.0, std::round(grey)));
    }
  return image;
}

/// What a data sheet says of this camera: neither offset, rotation nor exit pupil.
inline LightFieldCalibration sheet_of(const LightFieldCalibration& camera) {
  LightFieldCalibration sheet = camera;
  sheet.lenslets.rotation_deg = 0, sheet.lenslets.offset_um = {0, 0}, sheet.lens.exit_pupil_mm = 0;
  sheet.lenslets.distortion_x_um.clear(), sheet.lenslets.distortion_y_um.clear();
  return sheet;
}

/// Distances between the sub-images that `found` expects and those of `camera`, px, sorted.
inline std::vector<double> spot_errors_px(const FoundLenslets& found, const LightFieldCalibration& camera) {
  const LensletGeometry lattice(camera.true_lattice());
  const SensorFrame frame(camera);
  const double scale = camera.apparent_scale();
  std::vector<double> errors;
  for (const auto& s : found.spots) {
    const auto at = frame.to_mm({s.predicted_x_px, s.predicted_y_px});
    const auto near = lattice.nearest_of(at[0] / scale, at[1] / scale);
    const auto p = lattice.position_mm(near[0], near[1]);
    const auto truth = frame.to_px({p[0] * scale, p[1] * scale});
    errors.push_back(std::hypot(s.predicted_x_px - truth[0], s.predicted_y_px - truth[1]));
  }
  std::sort(errors.begin(), errors.end());
  return errors;
}

}  // namespace rptv::testing
