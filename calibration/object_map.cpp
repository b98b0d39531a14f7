// SPDX-License-Identifier: MIT
// The main lens as a map between image and object space.
#include "calibration/object_map.hpp"

#include <limits>

namespace rptv {

ObjectMap::ObjectMap(const LightFieldCalibration& calibration)
    : telecentric_(calibration.lens.model == "telecentric"),
      focal_mm_(calibration.lens.focal_length_mm),
      image_distance_mm_(calibration.lens.array_distance_mm),
      object_distance_mm_(0),
      magnification_(calibration.magnification()),
      index_(calibration.lens.medium_index) {
  calibration.validate("the light-field calibration");
  if (!telecentric_)
    object_distance_mm_ = focal_mm_ * image_distance_mm_ / (image_distance_mm_ - focal_mm_);  // eq. (8)
}

Point3 ObjectMap::to_object(const Point3& image) const noexcept {
  if (telecentric_)  // eq. (11)
    return {-image[0] / magnification_, -image[1] / magnification_,
            -index_ * image[2] / (magnification_ * magnification_)};
  const double behind = image_distance_mm_ - image[2];        // s'
  const double reduction = focal_mm_ / (behind - focal_mm_);  // s/s', eq. (8)
  return {-reduction * image[0], -reduction * image[1],
          index_ * (object_distance_mm_ - reduction * behind)};  // eq. (9)
}

Point3 ObjectMap::to_image(const Point3& object) const noexcept {
  if (telecentric_)
    return {-object[0] * magnification_, -object[1] * magnification_,
            -object[2] * magnification_ * magnification_ / index_};
  const double before = object_distance_mm_ - object[2] / index_;  // s
  const double enlargement = focal_mm_ / (before - focal_mm_);     // s'/s
  return {-enlargement * object[0], -enlargement * object[1], image_distance_mm_ - enlargement * before};
}

Matrix3 ObjectMap::jacobian(const Point3& image) const noexcept {
  if (telecentric_) {
    const double lateral = -1 / magnification_;
    return {{{lateral, 0, 0}, {0, lateral, 0}, {0, 0, -index_ / (magnification_ * magnification_)}}};
  }
  const double past_focus = image_distance_mm_ - image[2] - focal_mm_;  // s' - EFL
  const double reduction = focal_mm_ / past_focus;
  const double growth = reduction / past_focus;  // d(reduction)/dz
  return {{{-reduction, 0, -growth * image[0]},
           {0, -reduction, -growth * image[1]},
           {0, 0, -index_ * reduction * reduction}}};
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
  return telecentric_ ? std::numeric_limits<double>::infinity() : image_distance_mm_ - focal_mm_;
}

}  // namespace rptv
