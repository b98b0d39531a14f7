// SPDX-License-Identifier: MIT
// What must be known about a light-field camera to turn a pixel into a ray, and a point of image space into the object.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/light_field/calibration_arrays.hpp"
#include "calibration/light_field/lenslet_geometry.hpp"
#include "core/settings.hpp"

namespace rptv {

/// The camera chip. Sensor frame: mm, origin on the optical axis, x along columns, y along rows (rows grow downwards).
struct SensorCalibration {
  std::int64_t width_px = 0, height_px = 0;
  double pixel_um = 0;
  std::vector<double> optical_axis_px;  ///< column, row where the optical axis meets the chip; empty: the image centre
  void fields(FieldList& list);
};

/// The microlens array, parallel to the sensor at `focal_length_mm` in front of it.
struct LensletCalibration {
  double pitch_um = 0;
  double focal_length_mm = 0;
  double rotation_deg = 0;
  std::vector<double> offset_um{0, 0};  ///< true centre (iu, iv) = offset + pitch·Rot(rotation)·(iu, iv), sensor frame
  std::string shape = "square";         ///< "square" or "hexagonal"
  std::vector<double> distortion_x_um{};  ///< none, or the factors of distortion_terms() of the true lattice
  std::vector<double> distortion_y_um{};
  std::string arrays;  ///< HDF5 file with mask, vignetting and dark level, relative to the calibration file
  void fields(FieldList& list);
};

/// The main lens, as seen from the array and as a map between image and object space.
struct MainLensCalibration {
  std::string model;          ///< "thick_lens" (eq. 8-9), "telecentric" (eq. 11) or "polynomial" (Soloff)
  double exit_pupil_mm = 0;   ///< distance of the exit pupil in front of the array; 0: at infinity (telecentric)
  double image_f_number = 0;  ///< distance over diameter of the cone that reaches the array; 0: unknown
  std::vector<double> rim_shift, rim_radius_mm;  ///< of at most two rims that cut the exit pupil: see PupilRim
  double focal_length_mm = 0;                    ///< thick lens: EFL
  double array_distance_mm = 0;                  ///< thick lens: array behind the principal plane H2, s'_0
  double magnification = 0;                      ///< telecentric: M; the thick lens has its own (s'_0 - EFL)/EFL
  double medium_index = 1;                       ///< refractive index of the medium that the particles are in
  void fields(FieldList& list);
};

/// lens.model = "polynomial": the map of `base` followed by soloff_terms() times these factors.
struct PolynomialCalibration {
  std::string base = "thick_lens";     ///< the lens by its data sheet, that the polynomial corrects: as lens.model
  std::vector<double> from_mm, to_mm;  ///< box, in the object space of `base`, that the polynomial scales to -1 … 1
  std::vector<double> object_x_mm, object_y_mm, object_z_mm;
  void fields(FieldList& list);
};

/// One light-field camera. A plain value; reading it is set-up, everything else may be called from any thread.
struct LightFieldCalibration {
  static constexpr std::int64_t kSchema = 1;
  SensorCalibration sensor;
  LensletCalibration lenslets;
  MainLensCalibration lens;
  PolynomialCalibration polynomial;
  CalibrationArrays arrays;  ///< from the arrays file; empty: not known

  void fields(FieldList& list);

  double pixel_mm() const noexcept { return sensor.pixel_um * 1e-3; }
  double pitch_mm() const noexcept { return lenslets.pitch_um * 1e-3; }
  /// lens.model, or what it corrects: "thick_lens" or "telecentric".
  const std::string& base_model() const noexcept { return lens.model == "polynomial" ? polynomial.base : lens.model; }
  /// Lattice of the lenslets' centres.
  LatticeParameters true_lattice() const;
  /// Column and row of the optical axis, px.
  std::array<double, 2> optical_axis_px() const noexcept;
  /// Spot distance over centre distance from the axis, 1 + f/D: the two lattices (1 for a telecentric lens).
  double apparent_scale() const noexcept;
  /// Paraxial lateral magnification s'_0/s_0 at the plane conjugate to the array; positive.
  double magnification() const noexcept;
  /// Diameter of a sub-image in apparent pitches; more than 1 means overlap; 0 when the f-number is unknown.
  double subimage_overlap() const noexcept;
  /// What a user should know before trusting this camera, one line each (overlapping sub-images, unknown f-number).
  std::vector<std::string> warnings() const;
  /// Checks what spans several fields; throws Error(configuration) that names `origin`, value and next step.
  void validate(const std::string& origin) const;
};

/// Reads and validates a calibration file and its arrays file. Throws Error(no_input, configuration,
/// bad_data) with `file:line: …`. Set-up only.
LightFieldCalibration read_light_field_calibration(const std::filesystem::path& file);

/// The same from TOML text, without the arrays file; `origin` stands for the file's name in messages.
LightFieldCalibration parse_light_field_calibration(std::string_view text, const std::string& origin);

/// The calibration as a TOML file; read_light_field_calibration() gives the same values back. Throws Error(io).
void write_light_field_calibration(LightFieldCalibration calibration, const std::filesystem::path& file);

}  // namespace rptv
