// SPDX-License-Identifier: MIT
// Rims that cut the exit pupil, from sub-images whose light and centroid are worked out here point by point.
#include "calibration/light_field/pupil_rims.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "calibration/light_field/calibrate_lenslets.hpp"
#include "tests/calibration/light_field/white_image.hpp"

namespace rptv {
namespace {

using testing::white_camera;

constexpr double kShiftTolerance = 0.03, kRadiusTolerance = 0.02;  // of the true values
constexpr int kAcross = 61;                                        // points of the pupil along x and y

double pupil_mm(const LightFieldCalibration& c) { return 0.5 * c.lens.exit_pupil_mm / c.lens.image_f_number; }

bool is_open(const std::vector<PupilRim>& rims, double p_x, double p_y, double array_x, double array_y) {
  return std::all_of(rims.begin(), rims.end(), [&](const PupilRim& rim) {
    return std::hypot(p_x + rim.shift * array_x, p_y + rim.shift * array_y) < rim.radius_mm;
  });
}

/// Light and centroid of one sub-image.
void look_through(FoundSpot& spot, const LightFieldCalibration& c, const std::vector<PupilRim>& rims) {
  const auto axis = c.optical_axis_px();
  const double array_x = (spot.predicted_x_px - axis[0]) * c.pixel_mm() / c.apparent_scale();
  const double array_y = (spot.predicted_y_px - axis[1]) * c.pixel_mm() / c.apparent_scale();
  double whole = 0, open = 0, sum_x = 0, sum_y = 0;
  for (int i = 0; i < kAcross; ++i)
    for (int j = 0; j < kAcross; ++j) {
      const double x = pupil_mm(c) * (2.0 * i / (kAcross - 1) - 1), y = pupil_mm(c) * (2.0 * j / (kAcross - 1) - 1);
      if (std::hypot(x, y) > pupil_mm(c)) continue;
      ++whole;
      if (is_open(rims, x, y, array_x, array_y)) ++open, sum_x += x, sum_y += y;
    }
  spot.light = open / whole, spot.matched = open > 0;
  const double px_per_mm = -c.lenslets.focal_length_mm / c.lens.exit_pupil_mm / c.pixel_mm();
  spot.centroid_x_px = spot.predicted_x_px + (open > 0 ? sum_x / open * px_per_mm : 0);
  spot.centroid_y_px = spot.predicted_y_px + (open > 0 ? sum_y / open * px_per_mm : 0);
}

FoundLenslets found_through(const LightFieldCalibration& c, const std::vector<PupilRim>& rims) {
  FoundLenslets found;
  found.diameter_px = 2 * pupil_mm(c) * c.lenslets.focal_length_mm / c.lens.exit_pupil_mm / c.pixel_mm();
  const double pitch_px = c.pitch_mm() * c.apparent_scale() / c.pixel_mm();
  const auto axis = c.optical_axis_px();
  for (double row = pitch_px; row < static_cast<double>(c.sensor.height_px) - pitch_px; row += pitch_px)
    for (double column = pitch_px; column < static_cast<double>(c.sensor.width_px) - pitch_px; column += pitch_px) {
      FoundSpot spot;
      spot.predicted_x_px = column, spot.predicted_y_px = row;
      look_through(spot, c, rims);
      found.spots.push_back(spot);
      found.field_radius_px = std::max(found.field_radius_px, std::hypot(column - axis[0], row - axis[1]));
    }
  return found;
}

FoundLenslets with_noise(FoundLenslets found, unsigned seed) {
  constexpr double kCentroidPx = 0.05, kLight = 0.02;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  for (auto& s : found.spots) {
    s.centroid_x_px += kCentroidPx * normal(random), s.centroid_y_px += kCentroidPx * normal(random);
    s.light += kLight * normal(random);
  }
  return found;
}

LightFieldCalibration large_camera() { return white_camera(1200, 900); }

/// A rim on either side of the stop that begins to cut at this share of the field's radius.
std::vector<PupilRim> rims_from(const LightFieldCalibration& c, double shift, double before, double other_shift,
                                double behind) {
  const double field_mm = 0.5 * std::hypot(1200, 900) * c.pixel_mm() / c.apparent_scale();
  return {{-shift, pupil_mm(c) + shift * before * field_mm},
          {other_shift, pupil_mm(c) + other_shift * behind * field_mm}};
}

void expect_near(std::vector<PupilRim> rims, const std::vector<PupilRim>& truth) {
  ASSERT_EQ(rims.size(), truth.size());
  std::sort(rims.begin(), rims.end(), [](const PupilRim& a, const PupilRim& b) { return a.shift < b.shift; });
  for (std::size_t k = 0; k < rims.size(); ++k) {
    EXPECT_NEAR(rims[k].shift / truth[k].shift, 1, kShiftTolerance);
    EXPECT_NEAR(rims[k].radius_mm / truth[k].radius_mm, 1, kRadiusTolerance);
  }
}

TEST(PupilRims, are_found_on_either_side_of_the_stop) {
  const auto camera = large_camera();
  const auto truth = rims_from(camera, 0.35, 0.4, 0.25, 0.5);
  const auto found = found_through(camera, truth);
  expect_near(fit_pupil_rims(found, camera), truth);
  for (unsigned seed = 1; seed <= 3; ++seed) expect_near(fit_pupil_rims(with_noise(found, seed), camera), truth);
}

TEST(PupilRims, are_as_many_as_cut_the_field) {
  const auto camera = large_camera();
  const std::vector<PupilRim> one{rims_from(camera, 0.4, 0.4, 0.25, 0.5)[0]};
  expect_near(fit_pupil_rims(with_noise(found_through(camera, one), 1), camera), one);
}

/// A white image in which every pixel shows its point of the pupil, if that is open.
GreyImage draw_cats_eyes(const LightFieldCalibration& c, const std::vector<PupilRim>& rims) {
  constexpr int kSub = 3;
  constexpr double kElectrons = 240, kGain = 4, kReadNoise = 0.5;
  const LensletGeometry lattice(c.true_lattice());
  const SensorFrame frame(c);
  GreyImage image(static_cast<int>(c.sensor.width_px), static_cast<int>(c.sensor.height_px));
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int row = 0; row < image.height; ++row)
    for (int column = 0; column < image.width; ++column) {
      const auto middle = frame.to_mm({static_cast<double>(column), static_cast<double>(row)});
      const auto near = lattice.nearest_of(middle[0] / c.apparent_scale(), middle[1] / c.apparent_scale());
      const auto centre = lattice.position_mm(near[0], near[1]);
      int open = 0;
      for (int k = 0; k < kSub * kSub; ++k) {
        const auto at = frame.to_mm({column + (k % kSub + 0.5) / kSub - 0.5, row + (k / kSub + 0.5) / kSub - 0.5});
        const double to_pupil = c.lens.exit_pupil_mm / c.lenslets.focal_length_mm;
        const double p_x = centre[0] + (centre[0] - at[0]) * to_pupil, p_y = centre[1] + (centre[1] - at[1]) * to_pupil;
        open += std::hypot(p_x, p_y) < pupil_mm(c) && is_open(rims, p_x, p_y, centre[0], centre[1]) ? 1 : 0;
      }
      const double electrons = kElectrons * open / (kSub * kSub);
      const double grey = (electrons + std::sqrt(electrons) * normal(random)) / kGain + kReadNoise * normal(random);
      image.at(column, row) = static_cast<float>(std::max(0.0, std::round(grey)));
    }
  return image;
}

TEST(PupilRims, are_found_in_a_white_image_at_full_aperture) {
  auto camera = large_camera();
  camera.sensor.optical_axis_px = {599.5, 449.5};
  const auto truth = rims_from(camera, 0.35, 0.5, 0.25, 0.6);
  const GreyImage image = draw_cats_eyes(camera, truth);
  auto sheet = testing::sheet_of(camera);
  FindOptions options;
  options.origin = "white.png";
  const auto result = separate_lattices(find_lenslets(image, sheet, options), sheet, {}, "white.png");
  expect_near(fit_pupil_rims(result.found, result.calibration), truth);
}

TEST(PupilRims, are_none_where_there_is_nothing_to_fit) {
  const auto camera = large_camera();
  const auto truth = rims_from(camera, 0.35, 0.4, 0.25, 0.5);
  const auto found = with_noise(found_through(camera, truth), 1);
  ASSERT_EQ(fit_pupil_rims(found, camera).size(), 2U);
  EXPECT_TRUE(fit_pupil_rims(with_noise(found_through(camera, {}), 1), camera).empty());  // nothing is cut
  auto telecentric = camera;
  telecentric.lens.exit_pupil_mm = 0;
  EXPECT_TRUE(fit_pupil_rims(found, telecentric).empty());
  auto overlapping = found;
  overlapping.overlapping = true;
  EXPECT_TRUE(fit_pupil_rims(overlapping, camera).empty());
  auto few = found;
  few.spots.resize(20);
  EXPECT_TRUE(fit_pupil_rims(few, camera).empty());
  auto other = with_noise(found_through(camera, {truth[0]}), 1);  // they move, but the light stays
  for (auto& s : other.spots) s.light = 0.94;
  EXPECT_TRUE(fit_pupil_rims(other, camera).empty());
}

}  // namespace
}  // namespace rptv
