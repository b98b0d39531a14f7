// SPDX-License-Identifier: MIT
// What a simulated light-field camera consists of: main lens, microlens array, camera.
#pragma once

#include <string>
#include <vector>

#include "core/settings.hpp"

namespace rptv {

/// The lens between particles and microlens array.
struct MainLensSettings {
  std::string model = "thick_lens";  ///< or "prescription" (traced surfaces), "aplanat" (ideal telecentric objective)
  double focus_distance_mm = 35.0;   ///< from H1 to the plane conjugate to the microlens array (object z = 0)
  double magnification = 0;          ///< above 0: sets the focus distance; the aplanat needs it
  // thick lens: cardinal planes H1, H2 (eq. 8, 9) and a pupil
  double efl_mm = 25.0;
  double entrance_pupil_mm = 3.0;  ///< behind H1
  double f_number = 9.0;           ///< efl / entrance pupil diameter
  // prescription
  std::string prescription;                     ///< name of one that is installed, or path of a file
  double stop_radius_mm = 0;                    ///< 0: as wide as the prescription has it
  std::vector<double> rim_z_mm, rim_radius_mm;  ///< round holes besides the lens's own: z from the first vertex
  // aplanat: sine condition, 4f, with the medium behind a plane window
  double numerical_aperture = 0.5;
  double medium_index = 1.333;
  double window_mm = 0.1;  ///< from the focused plane to the window, in the medium
  void fields(FieldList& list);
};

/// Square cells of lenslets, sensor in their focal plane. Thin: light of slope s leaves at centre + s f. Plano-convex:
/// Snell's law at the sphere, which faces the main lens, and at the plane.
struct LensletArraySettings {
  std::string model = "thin";  ///< or "plano_convex"
  double pitch_mm = 0.125;
  double focal_length_mm = 3.75;
  double index = 1.56;              ///< plano-convex: radius = (index - 1) f, eq. (10)
  double plate_thickness_mm = 0.1;  ///< plano-convex: vertex to plane
  double rotation_deg = 0.19;
  double offset_x_mm = -0.0222, offset_y_mm = 0.0287;  ///< centre of lenslet (0, 0), image space
  bool diffraction = true;                             ///< of a square lenslet: sinc^2 in x and y
  double wavelength_nm = 532.0;
  void fields(FieldList& list);
};

/// Ideal mono camera: Poisson photoelectrons, Gaussian read noise, linear gain, clipping.
struct CameraSettings {
  std::int64_t width_px = 960, height_px = 960;
  double pixel_um = 18.0;
  std::int64_t bits = 12;
  double gain_e_per_dn = 4.0;
  double read_noise_e = 0.9;
  double black_level_dn = 32.0;
  double background_e = 0.0;  ///< stray light per pixel, photoelectrons
  bool noise = true;          ///< shot and read noise; false: expected values, rounded
  void fields(FieldList& list);
};

}  // namespace rptv
