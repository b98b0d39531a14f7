// SPDX-License-Identifier: MIT
// Fields, ranges and derived figures of a light-field calibration.
#include "calibration/light_field_calibration.hpp"

#include <fmt/format.h>

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
  list.choice("shape", shape, {"square"}, "arrangement of the lenslets");
}

void MainLensCalibration::fields(FieldList& list) {
  list.choice("model", model, {"thick_lens", "telecentric"}, "map between image and object space (eq. 8-9 or eq. 11)")
      .required = true;
  list.number("exit_pupil_mm", exit_pupil_mm, 0, 1e7,
              "distance of the exit pupil in front of the array; 0: at infinity (telecentric)")
      .required = true;
  list.number("image_f_number", image_f_number, 0, 1e4, "f-number of the cone that reaches the array; 0: unknown");
  list.number("focal_length_mm", focal_length_mm, 0, 1e5, "thick lens: effective focal length");
  list.number("array_distance_mm", array_distance_mm, 0, 1e6, "thick lens: array behind the principal plane H2");
  list.number("magnification", magnification, 0, 1e4, "telecentric: lateral magnification");
  list.number("medium_index", medium_index, 1, 3, "refractive index of the medium round the particles");
}

void LightFieldCalibration::fields(FieldList& list) {
  list.section("sensor", sensor);
  list.section("lenslets", lenslets);
  list.section("lens", lens);
}

std::array<double, 2> LightFieldCalibration::optical_axis_px() const noexcept {
  if (sensor.optical_axis_px.size() == 2) return {sensor.optical_axis_px[0], sensor.optical_axis_px[1]};
  return {0.5 * static_cast<double>(sensor.width_px - 1), 0.5 * static_cast<double>(sensor.height_px - 1)};
}

double LightFieldCalibration::apparent_scale() const noexcept {
  return lens.exit_pupil_mm > 0 ? 1 + lenslets.focal_length_mm / lens.exit_pupil_mm : 1;
}

double LightFieldCalibration::magnification() const noexcept {
  if (lens.model == "telecentric") return lens.magnification;
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
  if (lens.model == "telecentric" && !(lens.magnification > 0))
    refuse("lens.magnification is missing; a telecentric lens needs it above 0");
  if (lens.model == "thick_lens") {
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
  return read_with(
      [&](FieldList& list) { read_toml_file(file, "light-field calibration", LightFieldCalibration::kSchema, list); },
      file.string());
}

LightFieldCalibration parse_light_field_calibration(std::string_view text, const std::string& origin) {
  return read_with(
      [&](FieldList& list) {
        read_toml_text(text, origin, "light-field calibration", LightFieldCalibration::kSchema, list);
      },
      origin);
}

}  // namespace rptv
