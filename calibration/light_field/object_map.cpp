// SPDX-License-Identifier: MIT
// The main lens as a map between image and object space.
#include "calibration/light_field/object_map.hpp"

#include <limits>

namespace rptv {

namespace {

std::variant<ThickLens, Telecentric> lens_of(const LightFieldCalibration& calibration) {
  const auto& lens = calibration.lens;
  if (calibration.base_model() == "telecentric") return Telecentric{lens.magnification, lens.medium_index};
  const double s = lens.focal_length_mm * lens.array_distance_mm / (lens.array_distance_mm - lens.focal_length_mm);
  return ThickLens{lens.focal_length_mm, lens.array_distance_mm, s, lens.medium_index};  // eq. (8)
}

std::variant<ThickLens, Telecentric, CorrectedLens> model_of(const LightFieldCalibration& calibration) {
  calibration.validate("the light-field calibration");
  const auto lens = lens_of(calibration);
  if (calibration.lens.model == "polynomial") return CorrectedLens{lens, SoloffPolynomial(calibration.polynomial)};
  return std::visit([](const auto& l) { return std::variant<ThickLens, Telecentric, CorrectedLens>(l); }, lens);
}

}  // namespace

Point3 ThickLens::to_object(const Point3& image) const noexcept {
  const double behind = image_distance_mm - image[2];       // s'
  const double reduction = focal_mm / (behind - focal_mm);  // s/s', eq. (8)
  return {-reduction * image[0], -reduction * image[1], index * (object_distance_mm - reduction * behind)};  // eq. (9)
}

Point3 ThickLens::to_image(const Point3& object) const noexcept {
  const double before = object_distance_mm - object[2] / index;  // s
  const double enlargement = focal_mm / (before - focal_mm);     // s'/s
  return {-enlargement * object[0], -enlargement * object[1], image_distance_mm - enlargement * before};
}

Matrix3 ThickLens::jacobian(const Point3& image) const noexcept {
  const double past_focus = image_distance_mm - image[2] - focal_mm;  // s' - EFL
  const double reduction = focal_mm / past_focus;
  const double growth = reduction / past_focus;  // d(reduction)/dz
  return {{{-reduction, 0, -growth * image[0]},
           {0, -reduction, -growth * image[1]},
           {0, 0, -index * reduction * reduction}}};
}

Point3 Telecentric::to_object(const Point3& image) const noexcept {  // eq. (11)
  return {-image[0] / magnification, -image[1] / magnification, -index * image[2] / (magnification * magnification)};
}

Point3 Telecentric::to_image(const Point3& object) const noexcept {
  return {-object[0] * magnification, -object[1] * magnification, -object[2] * magnification * magnification / index};
}

Matrix3 Telecentric::jacobian(const Point3&) const noexcept {
  const double lateral = -1 / magnification;
  return {{{lateral, 0, 0}, {0, lateral, 0}, {0, 0, -index / (magnification * magnification)}}};
}

double Telecentric::highest_z_mm() const noexcept { return std::numeric_limits<double>::infinity(); }

Point3 CorrectedLens::to_object(const Point3& image) const noexcept {
  return correction.map(std::visit([&](const auto& l) { return l.to_object(image); }, lens));
}

Point3 CorrectedLens::to_image(const Point3& object) const noexcept {
  const Point3 by_the_lens = correction.inverse(object);
  return std::visit([&](const auto& l) { return l.to_image(by_the_lens); }, lens);
}

Matrix3 CorrectedLens::jacobian(const Point3& image) const noexcept {
  const Point3 by_the_lens = std::visit([&](const auto& l) { return l.to_object(image); }, lens);
  const Matrix3 inner = std::visit([&](const auto& l) { return l.jacobian(image); }, lens);
  const Matrix3 outer = correction.jacobian(by_the_lens);
  Matrix3 chained{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      for (std::size_t k = 0; k < 3; ++k) chained[row][column] += outer[row][k] * inner[k][column];
  return chained;
}

double CorrectedLens::highest_z_mm() const noexcept {
  return std::visit([](const auto& l) { return l.highest_z_mm(); }, lens);
}

ObjectMap::ObjectMap(const LightFieldCalibration& calibration) : model_(model_of(calibration)) {}

Point3 ObjectMap::to_object(const Point3& image) const noexcept {
  return std::visit([&](const auto& model) { return model.to_object(image); }, model_);
}

Point3 ObjectMap::to_image(const Point3& object) const noexcept {
  return std::visit([&](const auto& model) { return model.to_image(object); }, model_);
}

Matrix3 ObjectMap::jacobian(const Point3& image) const noexcept {
  return std::visit([&](const auto& model) { return model.jacobian(image); }, model_);
}

Covariance ObjectMap::to_object(const Covariance& c, const Matrix3& j) const noexcept {
  const Matrix3 full{{{c[0], c[1], c[2]}, {c[1], c[3], c[4]}, {c[2], c[4], c[5]}}};
  const auto element = [&](std::size_t row, std::size_t column) {
    double sum = 0;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) sum += j[row][a] * full[a][b] * j[column][b];
    return sum;
  };
  return {element(0, 0), element(0, 1), element(0, 2), element(1, 1), element(1, 2), element(2, 2)};
}

double ObjectMap::highest_z_mm() const noexcept {
  return std::visit([](const auto& model) { return model.highest_z_mm(); }, model_);
}

}  // namespace rptv
