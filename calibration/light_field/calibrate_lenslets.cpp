// SPDX-License-Identifier: MIT
// Checks the images, finds the apparent lattice, separates the true one, and collects the arrays.
#include "calibration/light_field/calibrate_lenslets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/light_field/pupil_rims.hpp"
#include "calibration/light_field/sensor_frame.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr double kMostSaturated = 0.03;   // of the bright pixels
constexpr double kMostPitchError = 0.05;  // of the data sheet's, when the pitch is fitted
constexpr double kTelecentric = 1e-4;     // scales nearer to 1 are telecentric
constexpr double kLeastLightForRays = 0.05;

[[noreturn]] void refuse(const std::string& origin, const std::string& text) {
  throw Error(ExitCode::bad_data, origin + ": " + text);
}

void check_exposure(const LensletImages& images) {
  const double share = images.images.saturated_share(images.significant_bits);
  if (images.particle_images || share <= kMostSaturated) return;
  refuse(images.origin,
         fmt::format("is saturated: {:.1f} % of its bright pixels are at {}, the highest of {} bits; halve the "
                     "exposure and take it again",
                     100 * share, (std::uint64_t{1} << images.significant_bits) - 1, images.significant_bits));
}

/// The true lattice that looks like `apparent` through an exit pupil that enlarges by `scale`.
void set_true_lattice(LightFieldCalibration& calibration, const LatticeParameters& apparent, double scale) {
  auto& lenslets = calibration.lenslets;
  lenslets.pitch_um = apparent.pitch_mm / scale * 1e3;
  lenslets.rotation_deg = apparent.rotation_rad * 180 / std::numbers::pi;
  lenslets.offset_um = {apparent.offset_mm[0] / scale * 1e3, apparent.offset_mm[1] / scale * 1e3};
  lenslets.distortion_x_um.clear(), lenslets.distortion_y_um.clear();
  const auto set = [](double c) { return c != 0; };
  if (std::none_of(apparent.distortion_x_mm.begin(), apparent.distortion_x_mm.end(), set) &&
      std::none_of(apparent.distortion_y_mm.begin(), apparent.distortion_y_mm.end(), set))
    return;
  const auto powers =
      distortion_terms(scale, scale);  // a term of order n is taken at positions that are 1/scale as far
  for (std::size_t k = 0; k < kDistortionTerms; ++k) {
    lenslets.distortion_x_um.push_back(apparent.distortion_x_mm[k] / scale * powers[k] * 1e3);
    lenslets.distortion_y_um.push_back(apparent.distortion_y_mm[k] / scale * powers[k] * 1e3);
  }
}

/// Moves (0, 0) to the lenslet nearest to the axis: numbers that people can compare.
LatticeParameters about_the_axis(const LatticeParameters& apparent, std::vector<FoundSpot>& spots) {
  LatticeParameters moved = apparent;
  const auto nearest = LensletGeometry(apparent).nearest_of(0, 0);
  moved.offset_mm = LensletGeometry(apparent).undistorted_mm(nearest[0], nearest[1]);
  for (auto& s : spots) s.u -= static_cast<int>(nearest[0]), s.v -= static_cast<int>(nearest[1]);
  return moved;
}

CalibrationArrays arrays_of(const FoundLenslets& found, const LensletImages& images) {
  CalibrationArrays arrays;
  LensletMask& fit = arrays.fit;
  std::int64_t last_u = -1'000'000, last_v = last_u;
  fit.first_u = fit.first_v = 1'000'000;
  for (const auto& s : found.spots) {
    fit.first_u = std::min<std::int64_t>(fit.first_u, s.u - 1), last_u = std::max<std::int64_t>(last_u, s.u + 1);
    fit.first_v = std::min<std::int64_t>(fit.first_v, s.v - 1), last_v = std::max<std::int64_t>(last_v, s.v + 1);
  }
  fit.columns = last_u - fit.first_u + 1, fit.rows = last_v - fit.first_v + 1;
  fit.reasons.assign(static_cast<std::size_t>(fit.columns * fit.rows), lenslet_reason::kBorder);
  arrays.ray = fit;
  std::fill(arrays.ray.reasons.begin(), arrays.ray.reasons.end(), std::uint8_t{0});
  arrays.vignetting.assign(fit.reasons.size(), 0), arrays.area = arrays.vignetting;
  for (const auto& s : found.spots) {
    const auto at = static_cast<std::size_t>((s.v - fit.first_v) * fit.columns + s.u - fit.first_u);
    fit.reasons[at] = s.reason;
    if (images.particle_images) continue;  // a lenslet that no particle lit is not a bad one, nor a dark one
    arrays.vignetting[at] = static_cast<float>(std::max(s.light, 0.0));
    arrays.area[at] = static_cast<float>(std::max(s.area, 0.0));
    if (s.light < kLeastLightForRays) arrays.ray.reasons[at] |= lenslet_reason::kBrightness;
    arrays.ray.reasons[at] |= static_cast<std::uint8_t>(s.reason & lenslet_reason::kResidual);
  }
  if (images.dark.images() == 0) return arrays;
  arrays.width_px = static_cast<std::uint32_t>(images.dark.width());
  arrays.height_px = static_cast<std::uint32_t>(images.dark.height());
  arrays.dark_level = dark_level_of(images.dark).grey, arrays.dark_noise = images.dark.noise().grey;
  return arrays;
}

}  // namespace

LensletCalibrationResult separate_lattices(const FoundLenslets& found, const LightFieldCalibration& start,
                                           const LensletKnowledge& known, const std::string& origin) {
  LensletCalibrationResult result{start, {}, found, start.lenslets.pitch_um, 0, !known.exit_pupil_known};
  auto& calibration = result.calibration;
  const double apparent_um = found.fit.lattice.pitch_mm * 1e3, focal_mm = start.lenslets.focal_length_mm;
  double scale = start.apparent_scale();
  if (known.exit_pupil_known) {
    const double pitch_um = apparent_um / scale;
    if (std::abs(pitch_um / start.lenslets.pitch_um - 1) > kMostPitchError)
      refuse(origin, fmt::format("with an exit pupil at {:.6g} mm the pitch would be {:.3f} um and the data sheet says "
                                 "{:.6g} um; check lens.exit_pupil_mm (0: telecentric), lenslets.pitch_um and "
                                 "sensor.pixel_um",
                                 start.lens.exit_pupil_mm, pitch_um, start.lenslets.pitch_um));
  } else {
    scale = apparent_um / start.lenslets.pitch_um;
    const double sigma = found.fit.pitch_sigma_mm * 1e3 / start.lenslets.pitch_um;
    if (std::abs(scale - 1) < std::max(kTelecentric, 3 * sigma)) scale = 1;
    if (scale < 1)
      refuse(origin,
             fmt::format("sub-images are {:.3f} um apart, nearer than the lenslets' {:.6g} um, and no exit pupil "
                         "does that; check lenslets.pitch_um and sensor.pixel_um, or give --exit-pupil-mm (0: "
                         "telecentric) to fit the pitch",
                         apparent_um, start.lenslets.pitch_um));
    calibration.lens.exit_pupil_mm = scale > 1 ? focal_mm / (scale - 1) : 0;
    result.exit_pupil_sigma_mm = scale > 1 ? calibration.lens.exit_pupil_mm * sigma / (scale - 1) : 0;
  }
  const LatticeParameters apparent = about_the_axis(found.fit.lattice, result.found.spots);
  set_true_lattice(calibration, apparent, scale);
  return result;
}

LensletCalibrationResult calibrate_lenslets(const LensletImages& images, const LightFieldCalibration& start,
                                            const LensletKnowledge& known) {
  check_exposure(images);
  FindOptions options;
  options.origin = images.origin, options.particle_images = images.particle_images;
  options.apparent_scale = known.exit_pupil_known ? start.apparent_scale() : 0;
  const bool dark = images.dark.images() > 0;
  if (dark && (images.dark.width() != images.images.width() || images.dark.height() != images.images.height()))
    refuse(images.origin,
           fmt::format("is {}x{} px and the dark image is {}x{}; take both with the same camera settings",
                       images.images.width(), images.images.height(), images.dark.width(), images.dark.height()));
  const double level = dark ? images.dark.level() : 0;
  GreyImage grey;
  if (images.particle_images) {
    grey = lit_in_any(images.images, level, dark ? images.dark.mean_noise() : 0);
  } else {
    grey = images.images.mean();
    options.dark_level = level;
  }
  auto result = separate_lattices(find_lenslets(grey, start, options), start, known, images.origin);
  result.arrays = arrays_of(result.found, images);
  result.calibration.arrays = result.arrays;
  if (images.particle_images) return result;
  auto& lens = result.calibration.lens;
  lens.rim_shift.clear(), lens.rim_radius_mm.clear();
  for (const auto& rim : fit_pupil_rims(result.found, result.calibration))
    lens.rim_shift.push_back(rim.shift), lens.rim_radius_mm.push_back(rim.radius_mm);
  return result;
}

}  // namespace rptv
