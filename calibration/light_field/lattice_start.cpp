// SPDX-License-Identifier: MIT
// Where the fit of a lattice begins, and what makes an image unfit for it.
#include "calibration/light_field/lattice_start.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/light_field/lattice_peak.hpp"
#include "calibration/light_field/sensor_frame.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

// Apparent pitches that a search allows, over the data sheet's: exit pupils from four focal lengths of the lenslets on.
constexpr double kLeast = 0.93, kMost = 1.25;
constexpr double kLeastPitchPx = 4, kLeastPeriods = 8, kMostSubharmonic = 0.4;
constexpr double kClearPeak = 5 * kSignificantPeak;  // the search of all periods has far more chances

[[noreturn]] void refuse(const FindOptions& options, const std::string& text) {
  throw Error(ExitCode::bad_data, options.origin + ": " + text);
}

[[noreturn]] void refuse_no_lattice(const GreyImage& image, const LightFieldCalibration& start,
                                    const FindOptions& options, double expected_px, double significance) {
  if (options.particle_images)
    refuse(options,
           fmt::format("particles have not lit enough sub-images to show a {} lattice near {:.2f} px (peak {:.1f} "
                       "times the spectrum round it, {:.0f} needed); give more particle images, or a white image",
                       start.lenslets.shape, expected_px, significance, kSignificantPeak));
  const auto any =
      find_lattice_peak(image, start.lenslets.shape, 3, std::min(image.width, image.height) / kLeastPeriods);
  if (any.significance > kClearPeak)
    refuse(options,
           fmt::format("shows a {} pattern with a period of {:.2f} px = {:.1f} um, but a pitch of {:.6g} um is "
                       "{:.2f} px; check lenslets.pitch_um, sensor.pixel_um and shape, or take an image without "
                       "moire (no binning, scaling or colour filter)",
                       start.lenslets.shape, any.pitch_px, any.pitch_px * start.sensor.pixel_um,
                       start.lenslets.pitch_um, expected_px));
  refuse(options,
         fmt::format("shows no {} lattice near {:.2f} px: its strongest peak there is {:.1f} times the spectrum "
                     "round it and {:.0f} are needed; take a white image that is neither empty nor out of "
                     "focus, and check pitch and shape",
                     start.lenslets.shape, expected_px, significance, kSignificantPeak));
}

}  // namespace

LatticeStart find_lattice_start(const GreyImage& image, const LightFieldCalibration& start,
                                const FindOptions& options) {
  const double pitch_px = start.lenslets.pitch_um / start.sensor.pixel_um;
  if (options.particle_images && start.subimage_overlap() > 1.02)
    refuse(options,
           fmt::format("sub-images are {:.2f} pitches wide at f/{:.4g}, and particle images show no borders where "
                       "sub-images overlap; take a white image, or stop the lens down",
                       start.subimage_overlap(), start.lens.image_f_number));
  const double scale = options.apparent_scale > 0 ? options.apparent_scale : 1;
  const double expected_px = pitch_px * scale;
  if (expected_px < kLeastPitchPx)
    refuse(options,
           fmt::format("a pitch of {:.6g} um is {:.2f} px and at least {} are needed to tell sub-images apart; "
                       "check lenslets.pitch_um and sensor.pixel_um",
                       start.lenslets.pitch_um, expected_px, kLeastPitchPx));
  if (std::min(image.width, image.height) < kLeastPeriods * expected_px)
    refuse(options, fmt::format("is {} x {} px and a pitch of {:.1f} px fits in fewer than {} times; check "
                                "lenslets.pitch_um and sensor.pixel_um",
                                image.width, image.height, expected_px, kLeastPeriods));
  const auto [darkest, brightest] = std::minmax_element(image.grey.begin(), image.grey.end());
  if (!(*brightest > *darkest))
    refuse(options, fmt::format("is empty: every pixel has the value {:.6g}; open the shutter or raise the exposure",
                                static_cast<double>(*darkest)));
  const double most = options.apparent_scale > 0 ? 2 - kLeast : kMost;
  const auto peak = find_lattice_peak(image, start.lenslets.shape, kLeast * expected_px, most * expected_px);
  if (peak.significance < kSignificantPeak) refuse_no_lattice(image, start, options, expected_px, peak.significance);
  if (peak.subharmonic > kMostSubharmonic)
    refuse(options, fmt::format("shows a lattice of {:.2f} px = {:.1f} um only as part of a coarser one; check "
                                "lenslets.pitch_um (data sheet: {:.6g} um) and shape",
                                peak.pitch_px, peak.pitch_px * start.sensor.pixel_um, start.lenslets.pitch_um));
  const SensorFrame frame(start);
  LatticeStart found;
  found.apparent = start.true_lattice();
  found.apparent.distortion_x_mm.fill(0), found.apparent.distortion_y_mm.fill(0);
  found.apparent.pitch_mm = peak.pitch_px * frame.pixel_mm, found.apparent.rotation_rad = peak.rotation_rad;
  found.apparent.offset_mm = frame.to_mm(peak.origin_px);
  found.significance = peak.significance;
  return found;
}

LatticeParameters moved_by_half(const LatticeParameters& lattice) {
  LatticeParameters moved = lattice;
  moved.offset_mm = LensletGeometry(lattice).undistorted_mm(0.5, 0.5);
  return moved;
}

}  // namespace rptv
