// SPDX-License-Identifier: MIT
// Fields, ranges and derived figures of a light-field calibration.
#include "calibration/light_field/light_field_calibration.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "calibration/light_field/soloff_polynomial.hpp"
#include "core/error.hpp"

namespace rptv {

void SensorCalibration::fields(FieldList& list) {
  list.integer("width_px", width_px, 1, 65536, "columns of the image").required = true;
  list.integer("height_px", height_px, 1, 65536, "rows of the image").required = true;
  list.number("pixel_um", pixel_um, 0.01, 1000, "pixel pitch").required = true;
  list.numbers("optical_axis_px", optical_axis_px, 0, -65536, 131072,
               "column and row where the optical axis meets the chip; empty: the image centre");
}

void LensletCalibration::fields(FieldList& list) {
  list.number("pitch_um", pitch_um, 0.1, 1e5, "distance between neighbouring lenslet centres").required = true;
  list.number("focal_length_mm", focal_length_mm, 1e-3, 1e4, "lenslet focal length = distance array to sensor")
      .required = true;
  list.number("rotation_deg", rotation_deg, -45, 45, "rotation of the lattice against the sensor's columns");
  list.numbers("offset_um", offset_um, 2, -1e6, 1e6, "true centre of lenslet (0, 0) from the optical axis: x, y");
  list.choice("shape", shape, {"square", "hexagonal"}, "arrangement of the lenslets");
  list.numbers(
      "distortion_x_um", distortion_x_um, 0, -1e6, 1e6,
      "x, y, x2, xy, y2, x3, x2y, xy2, y3 (in half diagonals of the sensor) of a smooth distortion; empty: none");
  list.numbers("distortion_y_um", distortion_y_um, 0, -1e6, 1e6, "the same for y");
  list.text("arrays", arrays, "HDF5 file with mask, vignetting and dark level, beside this file; empty: none");
}

void MainLensCalibration::fields(FieldList& list) {
  list.choice("model", model, {"thick_lens", "telecentric", "polynomial"},
              "map between image and object space (eq. 8-9, eq. 11, or fitted)")
      .required = true;
  list.number("exit_pupil_mm", exit_pupil_mm, 0, 1e7,
              "distance of the exit pupil in front of the array; 0: at infinity (telecentric)")
      .required = true;
  list.number("image_f_number", image_f_number, 0, 1e4, "f-number of the cone that reaches the array; 0: unknown");
  list.numbers("rim_shift", rim_shift, 0, -1e3, 1e3,
               "rims that make cat's eyes, at most two: open where |pupil point + shift x array point| < radius");
  list.numbers("rim_radius_mm", rim_radius_mm, 0, 1e-6, 1e6, "the same rims: radius on the exit pupil");
  list.number("focal_length_mm", focal_length_mm, 0, 1e5, "thick lens: effective focal length");
  list.number("array_distance_mm", array_distance_mm, 0, 1e6, "thick lens: array behind the principal plane H2");
  list.number("magnification", magnification, 0, 1e4, "telecentric: lateral magnification");
  list.number("medium_index", medium_index, 1, 3, "refractive index of the medium round the particles");
}

void PolynomialCalibration::fields(FieldList& list) {
  list.choice("base", base, {"thick_lens", "telecentric"}, "model 'polynomial': the lens that the polynomial corrects");
  list.numbers("from_mm", from_mm, 0, -1e5, 1e5, "lower corner of the polynomial's box, as the lens alone maps it");
  list.numbers("to_mm", to_mm, 0, -1e5, 1e5, "upper corner");
  list.numbers("object_x_mm", object_x_mm, 0, -1e9, 1e9, "19 factors (Soloff: third order, second in z)");
  list.numbers("object_y_mm", object_y_mm, 0, -1e9, 1e9, "the same for y");
  list.numbers("object_z_mm", object_z_mm, 0, -1e9, 1e9, "the same for z");
}

void LightFieldCalibration::fields(FieldList& list) {
  list.section("sensor", sensor);
  list.section("lenslets", lenslets);
  list.section("lens", lens);
  list.section("polynomial", polynomial);
}

LatticeParameters LightFieldCalibration::true_lattice() const {
  LatticeParameters lattice;
  lattice.shape = lenslets.shape;
  lattice.pitch_mm = pitch_mm();
  lattice.rotation_rad = lenslets.rotation_deg * std::numbers::pi / 180;
  for (std::size_t k = 0; k < 2; ++k) lattice.offset_mm[k] = lenslets.offset_um.at(k) * 1e-3;
  lattice.radius_mm =
      0.5 * pixel_mm() * std::hypot(static_cast<double>(sensor.width_px), static_cast<double>(sensor.height_px));
  for (std::size_t k = 0; k < lenslets.distortion_x_um.size(); ++k)
    lattice.distortion_x_mm.at(k) = lenslets.distortion_x_um[k] * 1e-3;
  for (std::size_t k = 0; k < lenslets.distortion_y_um.size(); ++k)
    lattice.distortion_y_mm.at(k) = lenslets.distortion_y_um[k] * 1e-3;
  return lattice;
}

std::array<double, 2> LightFieldCalibration::optical_axis_px() const noexcept {
  if (sensor.optical_axis_px.size() == 2) return {sensor.optical_axis_px[0], sensor.optical_axis_px[1]};
  return {0.5 * static_cast<double>(sensor.width_px - 1), 0.5 * static_cast<double>(sensor.height_px - 1)};
}

double LightFieldCalibration::apparent_scale() const noexcept {
  return lens.exit_pupil_mm > 0 ? 1 + lenslets.focal_length_mm / lens.exit_pupil_mm : 1;
}

double LightFieldCalibration::magnification() const noexcept {
  if (base_model() != "thick_lens") return lens.magnification;
  return lens.array_distance_mm / lens.focal_length_mm - 1;  // eq. (8): s'/s = s'/EFL - 1
}

double LightFieldCalibration::subimage_overlap() const noexcept {
  if (lens.image_f_number <= 0) return 0;
  return lenslets.focal_length_mm / lens.image_f_number / (pitch_mm() * apparent_scale());
}

std::vector<std::string> LightFieldCalibration::warnings() const {
  std::vector<std::string> lines;
  if (lens.image_f_number <= 0)
    lines.emplace_back("lens.image_f_number is unknown: whether sub-images overlap cannot be told");
  if (subimage_overlap() > 1.02)
    lines.push_back(
        fmt::format("sub-images overlap: {:.1f} pitches wide at f/{:.4g}, so a pixel belongs to several lenslets; stop "
                    "the lens down "
                    "to f/{:.3g} at the array or raise light_field.max_hypotheses",
                    subimage_overlap(), lens.image_f_number, lens.image_f_number * subimage_overlap()));
  return lines;
}

namespace {
constexpr double kMostDistortion = 0.03;

template <class Refuse>
void validate_polynomial(const PolynomialCalibration& p, const Refuse& refuse) {
  if (p.from_mm.size() != 3 || p.to_mm.size() != 3)
    refuse("polynomial.from_mm or to_mm has not 3 numbers; write this file with `rapidptv calibrate volume`");
  for (std::size_t k = 0; k < 3; ++k)
    if (!(p.from_mm[k] < p.to_mm[k]))
      refuse(
          fmt::format("polynomial.from_mm[{}] = {} is not below to_mm; write this file with `rapidptv "
                      "calibrate volume`",
                      k, p.from_mm[k]));
  for (const auto* factors : {&p.object_x_mm, &p.object_y_mm, &p.object_z_mm})
    if (factors->size() != kSoloffTerms)
      refuse(
          fmt::format("polynomial.object_x_mm, _y_mm and _z_mm need {} numbers each and one has {}; write this file "
                      "with `rapidptv calibrate volume`",
                      kSoloffTerms, factors->size()));
}
}  // namespace

void LightFieldCalibration::validate(const std::string& origin) const {
  const auto refuse = [&](const std::string& text) {
    throw Error(ExitCode::configuration, fmt::format("{}: {}", origin, text));
  };
  const auto axis = sensor.optical_axis_px.size();
  if (axis != 0 && axis != 2)
    refuse(fmt::format("sensor.optical_axis_px has {} numbers; give [column, row], or leave it out", axis));
  if (lenslets.pitch_um < 2 * sensor.pixel_um)
    refuse(fmt::format("lenslets.pitch_um = {} is less than two pixels of {} um; check both units", lenslets.pitch_um,
                       sensor.pixel_um));
  const LatticeParameters none;
  for (const auto* d : {&lenslets.distortion_x_um, &lenslets.distortion_y_um})
    if (!d->empty() && d->size() != kDistortionTerms)
      refuse(fmt::format("lenslets.distortion_x_um or _y_um has {} numbers; give {}, or none", d->size(),
                         kDistortionTerms));
  const double bend_mm = LensletGeometry(true_lattice()).largest_distortion_mm();
  if (!(bend_mm < kMostDistortion * true_lattice().radius_mm))
    refuse(
        fmt::format("lenslets.distortion_x_um and _y_um shift lenslets by {:.3g} um, more than {} % of half the "
                    "sensor's diagonal; calibrate again",
                    bend_mm * 1e3, kMostDistortion * 100));
  if (lens.rim_shift.size() != lens.rim_radius_mm.size() || lens.rim_shift.size() > 2)
    refuse(fmt::format("lens.rim_shift has {} numbers and lens.rim_radius_mm {}; give one each for up to two rims",
                       lens.rim_shift.size(), lens.rim_radius_mm.size()));
  if (base_model() == "telecentric" && !(lens.magnification > 0))
    refuse("lens.magnification is missing; a telecentric lens needs it above 0");
  if (lens.model == "polynomial") validate_polynomial(polynomial, refuse);
  if (base_model() == "thick_lens") {
    if (!(lens.focal_length_mm > 0)) refuse("lens.focal_length_mm is missing; a thick lens needs it above 0");
    if (!(lens.array_distance_mm > lens.focal_length_mm))
      refuse(
          fmt::format("lens.array_distance_mm = {} is not behind the focal length {} mm, so there is no real image; "
                      "give the distance from H2 to the lenslet array",
                      lens.array_distance_mm, lens.focal_length_mm));
    if (lens.magnification > 0)
      refuse(
          fmt::format("lens.magnification = {} contradicts model 'thick_lens', which has {:.6g} by its distances; "
                      "remove it",
                      lens.magnification, magnification()));
  }
}

namespace {
template <class Read>
LightFieldCalibration read_with(Read read, const std::string& origin) {
  LightFieldCalibration calibration;
  FieldList list;
  calibration.fields(list);
  read(list);
  calibration.validate(origin);
  return calibration;
}
}  // namespace

LightFieldCalibration read_light_field_calibration(const std::filesystem::path& file) {
  auto calibration = read_with(
      [&](FieldList& list) { read_toml_file(file, "light-field calibration", LightFieldCalibration::kSchema, list); },
      file.string());
  if (calibration.lenslets.arrays.empty()) return calibration;
  const auto arrays_file = file.parent_path() / calibration.lenslets.arrays;
  calibration.arrays = read_calibration_arrays(arrays_file);
  const auto& arrays = calibration.arrays;
  const auto& sensor = calibration.sensor;
  if (!arrays.dark_level.empty() && (arrays.width_px != sensor.width_px || arrays.height_px != sensor.height_px))
    throw Error(ExitCode::bad_data,
                fmt::format("{}: 'dark_level' has {}x{} px and the sensor of {} {}x{}; make both again with `rapidptv "
                            "calibrate lenslets`",
                            arrays_file.string(), arrays.width_px, arrays.height_px, file.string(), sensor.width_px,
                            sensor.height_px));
  return calibration;
}

void write_light_field_calibration(LightFieldCalibration calibration, const std::filesystem::path& file) {
  FieldList list;
  list.section("sensor", calibration.sensor);
  list.section("lenslets", calibration.lenslets);
  list.section("lens", calibration.lens);
  if (calibration.lens.model == "polynomial") list.section("polynomial", calibration.polynomial);
  std::ofstream stream(file, std::ios::binary);
  stream << to_toml(list, LightFieldCalibration::kSchema);
  if (!stream.flush())
    throw Error(ExitCode::io, fmt::format("{}: cannot be written; check folder, permissions and space", file.string()));
}

LightFieldCalibration parse_light_field_calibration(std::string_view text, const std::string& origin) {
  return read_with(
      [&](FieldList& list) {
        read_toml_text(text, origin, "light-field calibration", LightFieldCalibration::kSchema, list);
      },
      origin);
}

}  // namespace rptv
