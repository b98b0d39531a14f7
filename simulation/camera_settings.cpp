// SPDX-License-Identifier: MIT
// The fields of main lens, microlens array and camera.
#include "simulation/camera_settings.hpp"

namespace rptv {

void MainLensSettings::fields(FieldList& list) {
  list.choice("model", model, {"thick_lens", "prescription", "aplanat"},
              "cardinal planes, traced surfaces, or an ideal telecentric objective with tube lens");
  list.number("efl_mm", efl_mm, 1e-1, 1e4, "effective focal length, mm");
  list.number("focus_distance_mm", focus_distance_mm, 1e-1, 1e5, "H1 to the focused plane (object z = 0), mm");
  list.number("magnification", magnification, 0, 1e3,
              "above 0: sets the focus distance in place of focus_distance_mm; an aplanat needs it");
  list.number("entrance_pupil_mm", entrance_pupil_mm, -1e4, 1e4, "entrance pupil behind H1, mm");
  list.number("f_number", f_number, 0.5, 1e3, "efl / entrance pupil diameter");
  list.text("prescription", prescription, "model prescription: name of an installed lens, or path of a file");
  list.number("stop_radius_mm", stop_radius_mm, 0, 1e3, "model prescription: radius of the stop; 0: fully open");
  list.numbers("rim_z_mm", rim_z_mm, 0, -1e4, 1e4, "model prescription: more rims, z from the first vertex, mm");
  list.numbers("rim_radius_mm", rim_radius_mm, 0, 1e-3, 1e4, "model prescription: radii of those rims, mm");
  list.number("numerical_aperture", numerical_aperture, 1e-3, 1.6, "aplanat: numerical aperture at the object");
  list.number("medium_index", medium_index, 1, 2, "aplanat: refractive index of the medium behind the window");
  list.number("window_mm", window_mm, 0, 1e3, "aplanat: from the focused plane to the window, mm");
}

void LensletArraySettings::fields(FieldList& list) {
  list.choice("model", model, {"thin", "plano_convex"}, "ideal thin lenslets, or refraction at sphere and plane");
  list.number("pitch_mm", pitch_mm, 1e-3, 1e1, "lenslet pitch, mm");
  list.number("focal_length_mm", focal_length_mm, 1e-2, 1e3, "lenslet focal length = distance to the sensor, mm");
  list.number("index", index, 1.01, 4, "plano-convex: refractive index");
  list.number("plate_thickness_mm", plate_thickness_mm, 0, 10, "plano-convex: vertex to plane, mm");
  list.number("rotation_deg", rotation_deg, -45, 45, "rotation of the array against the sensor, degrees");
  list.number("offset_x_mm", offset_x_mm, -1e2, 1e2, "centre of lenslet (0, 0), mm");
  list.number("offset_y_mm", offset_y_mm, -1e2, 1e2, "centre of lenslet (0, 0), mm");
  list.flag("diffraction", diffraction, "blur by the square lenslet's diffraction (sinc^2)");
  list.number("wavelength_nm", wavelength_nm, 100, 2000, "wavelength of the light, nm");
}

void CameraSettings::fields(FieldList& list) {
  list.integer("width_px", width_px, 16, 16384, "image width, px");
  list.integer("height_px", height_px, 16, 16384, "image height, px");
  list.number("pixel_um", pixel_um, 0.5, 100, "pixel pitch, um");
  list.integer("bits", bits, 8, 16, "significant bits of a grey value");
  list.number("gain_e_per_dn", gain_e_per_dn, 1e-3, 1e4, "photoelectrons per grey value");
  list.number("read_noise_e", read_noise_e, 0, 1e3, "read noise, photoelectrons rms");
  list.number("black_level_dn", black_level_dn, -1e3, 1e4, "grey value of a dark pixel");
  list.number("background_e", background_e, 0, 1e5, "stray light per pixel and frame, photoelectrons");
  list.flag("noise", noise, "shot and read noise");
}

}  // namespace rptv
