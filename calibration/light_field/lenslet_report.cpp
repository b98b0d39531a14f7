// SPDX-License-Identifier: MIT
// Figures of a lenslet calibration as text and as JSON.
#include "calibration/light_field/lenslet_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/json.hpp"

namespace rptv {

namespace {

using namespace lenslet_reason;

std::size_t count_of(const FoundLenslets& found, std::uint8_t bits) {
  return static_cast<std::size_t>(std::count_if(found.spots.begin(), found.spots.end(),
                                                [&](const FoundSpot& s) { return (s.reason & bits) != 0; }));
}

std::size_t masked_of(const LensletMask& mask) {
  return static_cast<std::size_t>(
      std::count_if(mask.reasons.begin(), mask.reasons.end(), [](auto r) { return r != 0; }));
}

double distortion_px(const LensletCalibrationResult& r) {
  return LensletGeometry(r.found.fit.lattice).largest_distortion_mm() / r.calibration.pixel_mm();
}

}  // namespace

ResidualFigures residual_figures(const FoundLenslets& found) {
  std::vector<double> sizes;
  for (const auto& s : found.spots)
    if (s.reason == 0) sizes.push_back(std::hypot(s.x_px - s.predicted_x_px, s.y_px - s.predicted_y_px));
  if (sizes.empty()) return {};
  std::sort(sizes.begin(), sizes.end());
  return {sizes[sizes.size() / 2], sizes[static_cast<std::size_t>(0.95 * static_cast<double>(sizes.size() - 1))]};
}

std::string to_text(const LensletCalibrationResult& r) {
  const FoundLenslets& found = r.found;
  const auto& c = r.calibration;
  const ResidualFigures residual = residual_figures(found);
  const std::size_t intact = found.spots.size() - count_of(found, 0xff);
  const double scatter_px = found.fit.scatter_mm / c.pixel_mm();
  std::string text = fmt::format(
      "sub-images        {} on the sensor, {} fitted; left out: {} area, {} eccentricity, {} residual, {} brightness\n"
      "residuals         median {:.3f} px, 95 % below {:.3f} px; random error of the lattice about {:.4f} px\n",
      found.spots.size(), intact, count_of(found, kArea), count_of(found, kEccentricity), count_of(found, kResidual),
      count_of(found, kBrightness), residual.median_px, residual.p95_px,
      scatter_px * std::sqrt(static_cast<double>(found.fit.parameters) /
                             static_cast<double>(std::max<std::size_t>(2 * intact, 1))));
  const double across = static_cast<double>(c.sensor.width_px) * c.sensor.pixel_um / c.apparent_scale();
  text += fmt::format(
      "lattice           {}, apparent pitch {:.4f} um, rotation {:.4f} deg, offset {:.3f} {:.3f} um, distortion {}\n"
      "pitch             data sheet {:.4f} um, here {:.4f} um ({:+.3f} %): {:.1f} lenslets designed across the sensor, "
      "{:.1f} seen\n",
      c.lenslets.shape, found.fit.lattice.pitch_mm * 1e3, c.lenslets.rotation_deg, c.lenslets.offset_um[0],
      c.lenslets.offset_um[1],
      c.lenslets.distortion_x_um.empty() ? "none" : fmt::format("up to {:.2f} px", distortion_px(r)), r.sheet_pitch_um,
      c.lenslets.pitch_um, 100 * (c.lenslets.pitch_um / r.sheet_pitch_um - 1), across / r.sheet_pitch_um,
      across / c.lenslets.pitch_um);
  const double pupil = c.lens.exit_pupil_mm;
  if (!r.exit_pupil_fitted)
    text += fmt::format("exit pupil        {} (given; the pitch is fitted)\n",
                        pupil > 0 ? fmt::format("{:.6g} mm", pupil) : "at infinity");
  else if (pupil > 0)
    text += fmt::format(
        "exit pupil        {:.3f} mm, random error {:.3f} (from apparent over data-sheet pitch; 0.1 % of pitch would "
        "be {:.1f} "
        "mm)\n",
        pupil, r.exit_pupil_sigma_mm, 1e-3 * pupil * (pupil + c.lenslets.focal_length_mm) / c.lenslets.focal_length_mm);
  else
    text += "exit pupil        at infinity (apparent and data-sheet pitch agree)\n";
  text += fmt::format("sub-image         {:.2f} px wide = {:.2f} pitches (f/{:.1f} at this aperture){}\n",
                      found.diameter_px, found.diameter_px * c.pixel_mm() / found.fit.lattice.pitch_mm,
                      c.lenslets.focal_length_mm / (found.diameter_px * c.pixel_mm()),
                      found.overlapping ? "; they overlap: figures of the pattern, not of one" : "");
  text += fmt::format("masked            {} lenslets give no rays\n", masked_of(r.arrays.ray));
  if (found.intact_radius_px < 0.97 * found.field_radius_px)
    text += fmt::format(
        "extrapolated      intact sub-images end {:.0f} px from the middle, the farthest lenslet is at {:.0f} px\n",
        found.intact_radius_px, found.field_radius_px);
  if (found.distortion_unsure)
    text +=
        "warning           residuals show a distortion or uneven vignetting, and intact sub-images do not reach far "
        "enough "
        "to extrapolate it: it is left out\n";
  return text;
}

std::string to_json(const LensletCalibrationResult& r) {
  const FoundLenslets& found = r.found;
  const auto& c = r.calibration;
  const ResidualFigures residual = residual_figures(found);
  std::string text = "{";
  const auto put = [&](const char* name, double value) {
    text += (text.size() > 1 ? "," : "") + json_string(name) + ":" + json_number(value);
  };
  const auto count = [](std::size_t n) { return static_cast<double>(n); };
  put("lenslets", count(found.spots.size())), put("fitted", count(found.spots.size() - count_of(found, 0xff)));
  put("left_out_area", count(count_of(found, kArea))),
      put("left_out_eccentricity", count(count_of(found, kEccentricity)));
  put("left_out_residual", count(count_of(found, kResidual)));
  put("left_out_brightness", count(count_of(found, kBrightness))), put("masked", count(masked_of(r.arrays.ray)));
  put("residual_median_px", residual.median_px), put("residual_p95_px", residual.p95_px);
  put("scatter_px", found.fit.scatter_mm / c.pixel_mm());
  put("apparent_pitch_um", found.fit.lattice.pitch_mm * 1e3), put("sheet_pitch_um", r.sheet_pitch_um);
  put("pitch_um", c.lenslets.pitch_um), put("rotation_deg", c.lenslets.rotation_deg);
  put("offset_x_um", c.lenslets.offset_um[0]), put("offset_y_um", c.lenslets.offset_um[1]);
  put("distortion_px", distortion_px(r)), put("exit_pupil_mm", c.lens.exit_pupil_mm);
  put("exit_pupil_sigma_mm", r.exit_pupil_sigma_mm), put("subimage_diameter_px", found.diameter_px);
  put("intact_radius_px", found.intact_radius_px), put("field_radius_px", found.field_radius_px);
  put("peak_significance", found.peak_significance);
  return text + ",\"exit_pupil_fitted\":" + (r.exit_pupil_fitted ? "true" : "false") +
         ",\"overlapping\":" + (found.overlapping ? "true" : "false") +
         ",\"distortion_unsure\":" + (found.distortion_unsure ? "true" : "false") + "}";
}

}  // namespace rptv
