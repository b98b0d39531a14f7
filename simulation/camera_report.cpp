// SPDX-License-Identifier: MIT
// The description that `simulate --describe` prints.
#include "simulation/camera_report.hpp"

#include <fmt/format.h>

#include "simulation/lens_analysis.hpp"
#include "simulation/optics.hpp"
#include "simulation/shipped_file.hpp"

namespace rptv {

std::string describe_camera(const ScenarioSettings& scenario) {
  const LightFieldOptics optics(scenario);
  const FirstOrder& lens = optics.lens().first_order();
  const LightFieldCalibration camera = optics.calibration();
  std::string text;
  if (scenario.main_lens.model == "prescription")
    text += describe_lens(read_prescription(find_shipped("prescriptions", scenario.main_lens.prescription)),
                          scenario.main_lens.stop_radius_mm, optics.magnification(0));
  if (lens.efl_mm > 0)
    text += fmt::format(
        "main lens ({}): EFL {:.4f} mm, focused {:.4f} mm before H1, array {:.4f} mm behind H2, magnification {:.4f}\n"
        "  exit pupil {:.4f} mm before the array, radius {:.4f} mm\n",
        scenario.main_lens.model, lens.efl_mm, lens.focus_distance_mm, lens.array_distance_mm, optics.magnification(0),
        lens.exit_pupil_mm, optics.exit_pupil_radius_mm());
  else
    text +=
        fmt::format("main lens (aplanat): telecentric, magnification {:.4f}, aperture {:.3f}, medium index {:.4f}\n",
                    lens.fixed_magnification, scenario.main_lens.numerical_aperture, lens.medium_index);
  text += fmt::format(
      "array: {} lenslets, pitch {:.2f} um ({:.3f} px), apparent pitch {:.3f} px, cone f/{:.3f}: sub-images {:.2f} "
      "pitches wide\n"
      "field: {:.3f} × {:.3f} mm in the focused plane; {} particles in the lit box\n",
      scenario.lenslets.model, camera.lenslets.pitch_um, camera.lenslets.pitch_um / camera.sensor.pixel_um,
      camera.apparent_scale() * camera.lenslets.pitch_um / camera.sensor.pixel_um, camera.lens.image_f_number,
      camera.subimage_overlap(),
      static_cast<double>(camera.sensor.width_px) * camera.pixel_mm() / camera.magnification(),
      static_cast<double>(camera.sensor.height_px) * camera.pixel_mm() / camera.magnification(),
      optics.particles_in_box());
  for (const std::string& warning : camera.warnings()) text += "  " + warning + "\n";
  return text;
}

}  // namespace rptv
