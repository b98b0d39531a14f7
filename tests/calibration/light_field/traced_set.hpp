// SPDX-License-Identifier: MIT
// The ray-traced light-field sets for tests of calibrations: their cameras, their true spots and their true pairs.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <vector>

#include "calibration/light_field/calibrate_lenslets.hpp"
#include "calibration/light_field/correspondences.hpp"
#include "calibration/light_field/lenslet_report.hpp"
#include "tests/calibration/light_field/white_image.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv::testing {

inline LightFieldCalibration traced_camera(const std::string& name) {
  return read_light_field_calibration(std::string(RPTV_SOURCE_DIR "/tests/reconstruct/data/") + name);
}
inline LightFieldCalibration macro_truth() { return traced_camera("lf_macro_calibration.toml"); }
inline LightFieldCalibration wall_truth() { return traced_camera("lf_wall_calibration.toml"); }
inline LightFieldCalibration microscope_truth() { return traced_camera("lf_microchannel_calibration.toml"); }
inline LightFieldCalibration edge_truth() {  // the same lens, larger pixels, another array (truth.json of lf-edge)
  auto c = macro_truth();
  c.sensor.pixel_um = 8.7, c.lenslets.rotation_deg = 0.37, c.lenslets.offset_um = {2.871, -1.044};
  return c;
}

inline std::string set_of(const LightFieldCalibration& truth) {
  if (truth.lens.model == "telecentric") return "lf-microchannel";
  return truth.sensor.pixel_um == 4.35 ? "lf-macro" : truth.sensor.pixel_um == 8.7 ? "lf-edge" : "lf-wall";
}

struct Figures {
  double raw_median_px = 0;            ///< measured sub-images to true spots, those fitted
  double median_px = 0, worst_px = 0;  ///< the lattice to true spots, every lenslet on the sensor
  double exit_pupil_mm = 0;
};

struct Calibrated {
  LensletCalibrationResult result;
  Figures figures;
};

/// Calibrates from the set's images (several: particle images) and the data sheet alone, prints and returns the
/// figures.
inline Calibrated calibrated(const LightFieldCalibration& truth, const std::vector<std::string>& files) {
  const auto folder = *shared_set(set_of(truth));
  LensletImages images;
  images.origin = set_of(truth) + "/" + files.front(), images.particle_images = files.size() > 1;
  for (const auto& file : files) images.images.add(DecodedImage(folder / file).view(), file);
  if (std::filesystem::exists(folder / "dark.png"))
    images.dark.add(DecodedImage(folder / "dark.png").view(), "dark.png");
  const bool telecentric = truth.lens.model == "telecentric";
  Calibrated c{calibrate_lenslets(images, sheet_of(truth), {telecentric}), {}};
  const auto errors = spot_errors_px(c.result.found, truth);
  auto measured = c.result.found;
  std::erase_if(measured.spots, [](const FoundSpot& s) { return s.reason != 0; });
  for (auto& s : measured.spots) s.predicted_x_px = s.x_px, s.predicted_y_px = s.y_px;
  const auto raw = spot_errors_px(measured, truth);
  c.figures = {raw[raw.size() / 2], errors[errors.size() / 2], errors.back(), c.result.calibration.lens.exit_pupil_mm};
  fmt::print(
      "{}{}: {} of {} sub-images fitted; to the true spots: measured median {:.4f} px, lattice median {:.4f} px, "
      "worst {:.4f} px; exit pupil {:.3f} mm (true {:.3f}), pitch {:.4f} um\n",
      images.origin, files.size() > 1 ? fmt::format(" and {} more", files.size() - 1) : "", raw.size(), errors.size(),
      c.figures.raw_median_px, c.figures.median_px, c.figures.worst_px, c.figures.exit_pupil_mm,
      truth.lens.exit_pupil_mm, c.result.calibration.lenslets.pitch_um);
  return c;
}

/// Every traced particle of truth.json: where its rays converge, and where it is; z towards the lens in both spaces.
inline std::vector<Correspondence> traced_pairs(const std::string& set) {
  const std::string text = text_of(*shared_set(set) / "truth.json");
  constexpr double kFocusedDistanceMm = 100.71633391662732;  // from H1: the plane conjugate to the array
  const auto numbers = [&](const char* key, std::size_t from) {
    const auto open = text.find('[', text.find(key, from));
    Point3 p{};
    const std::string list = text.substr(open + 1, text.find(']', open) - open - 1);
    if (std::sscanf(list.c_str(), "%lf , %lf , %lf", &p[0], &p[1], &p[2]) != 3) p[0] = 1e9;
    return p;
  };
  std::vector<Correspondence> pairs;
  const std::string key = "\"plane\"";
  for (auto at = text.find(key); at != std::string::npos; at = text.find(key, at + 1)) {
    const auto object = numbers("\"object_mm\"", at), image = numbers("\"image_real_ls_mm\"", at);
    pairs.push_back({{image[0], image[1], -image[2]}, {object[0], object[1], kFocusedDistanceMm - object[2]}});
  }
  return pairs;
}

}  // namespace rptv::testing
