// SPDX-License-Identifier: MIT
// The lattice grows from the middle outwards: expect, judge the sub-images' shape, register intact ones, fit, repeat.
#include "calibration/light_field/find_lenslets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "calibration/light_field/lattice_start.hpp"
#include "calibration/light_field/sensor_frame.hpp"
#include "calibration/light_field/subimage_shape.hpp"
#include "calibration/light_field/subimage_template.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

using namespace lenslet_reason;

constexpr double kWindow = 0.56;  // of a pitch: registers a sub-image with the gap round it
constexpr double kCore = 8;       // pitches from the middle within which sub-images are taken for intact
constexpr double kGrowth = 1.6;
constexpr int kPassesAtEnd = 3;
constexpr int kNeighbours = 2;
constexpr double kLeastLoss = 0.03;  // of area or roundness: what counts as vignetted, at least
constexpr double kLeastLight = 0.25, kLeastOfNeighbours = 0.6;  // of the light on the axis: less is not fitted
constexpr double kReached = 0.85;  // of the field must be intact for a distortion to be fitted
constexpr double kMostGap = 0.15;  // grey between sub-images over their top: more means overlap

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

class Search {
 public:
  Search(const GreyImage& image, const LightFieldCalibration& start, const FindOptions& options)
      : image_(image), options_(options), start_(start), frame_(start) {
    const auto first = find_lattice_start(image, start, options);
    found_.fit.lattice = first.apparent, found_.peak_significance = first.significance;
    middle_ = {0.5 * (image.width - 1), 0.5 * (image.height - 1)};
    look_for_overlap();
  }

  FoundLenslets run() {
    const double farthest = std::hypot(middle_[0], middle_[1]);
    for (double reach = kCore * pitch_px(); reach < farthest; reach *= kGrowth) pass(reach);
    for (int k = 0; k < kPassesAtEnd; ++k) pass(farthest);
    finish();
    return std::move(found_);
  }

 private:
  double pitch_px() const noexcept { return found_.fit.lattice.pitch_mm / frame_.pixel_mm; }
  double from_middle(const FoundSpot& s) const noexcept {
    return std::hypot(s.predicted_x_px - middle_[0], s.predicted_y_px - middle_[1]);
  }
  [[noreturn]] void refuse(const std::string& text) const {
    throw Error(ExitCode::bad_data, options_.origin + ": " + text);
  }

  void expect(double reach);
  void judge_shapes();
  SubimageTemplate fold() const;
  /// Light between sub-images over their top.
  double gap_of(const SubimageTemplate& mean) const noexcept {
    return (mean.lowest() - options_.dark_level) / std::max(mean.highest() - options_.dark_level, 1e-300);
  }
  void pass(double reach);
  void look_for_overlap();
  void finish();

  const GreyImage& image_;
  const FindOptions& options_;
  const LightFieldCalibration& start_;
  const SensorFrame frame_;
  std::array<double, 2> middle_{};
  FoundLenslets found_;
  int columns_ = 0;  // of the rectangle of (u, v) in which spots_at_ says where a lenslet is in found_.spots
  std::vector<int> spot_at_;
};

/// Every lenslet whose window lies in the image and within `reach` px of its middle.
void Search::expect(double reach) {
  const LensletGeometry geometry(found_.fit.lattice);
  double low_u = 1e9, high_u = -1e9, low_v = 1e9, high_v = -1e9;
  for (const double x : {-0.5, 0.25, 0.5})
    for (const double y : {-0.5, 0.25, 0.5}) {
      const auto [u, v] = geometry.lattice_of((middle_[0] + x * image_.width - frame_.axis_px[0]) * frame_.pixel_mm,
                                              (middle_[1] + y * image_.height - frame_.axis_px[1]) * frame_.pixel_mm);
      low_u = std::min(low_u, u), high_u = std::max(high_u, u), low_v = std::min(low_v, v),
      high_v = std::max(high_v, v);
    }
  const double edge = kWindow * pitch_px();
  const int first_u = static_cast<int>(low_u) - 2, first_v = static_cast<int>(low_v) - 2;
  columns_ = static_cast<int>(high_u) + 3 - first_u;
  const int rows = static_cast<int>(high_v) + 3 - first_v;
  spot_at_.assign(static_cast<std::size_t>(columns_ * rows), -1);
  found_.spots.clear();
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns_; ++column) {
      FoundSpot spot;
      spot.u = first_u + column, spot.v = first_v + row;
      const auto at = frame_.to_px(geometry.position_mm(spot.u, spot.v));
      spot.predicted_x_px = at[0], spot.predicted_y_px = at[1];
      if (at[0] < edge || at[1] < edge || at[0] > image_.width - 1 - edge || at[1] > image_.height - 1 - edge) continue;
      if (from_middle(spot) > reach) continue;
      spot_at_[static_cast<std::size_t>(row * columns_ + column)] = static_cast<int>(found_.spots.size());
      found_.spots.push_back(spot);
    }
}

void Search::judge_shapes() {
  const double radius =
      found_.diameter_px > 0 ? std::min(0.5 * pitch_px(), 0.625 * found_.diameter_px + 1.5) : 0.5 * pitch_px();
  std::vector<SubimageMoments> own(spot_at_.size());
  for (std::size_t k = 0; k < spot_at_.size(); ++k)
    if (spot_at_[k] >= 0) {
      const auto& s = found_.spots[static_cast<std::size_t>(spot_at_[k])];
      own[k] = moments_of(image_, {s.predicted_x_px, s.predicted_y_px}, radius, options_.dark_level);
    }
  const auto near = sum_over_neighbours(own, columns_, kNeighbours);
  std::vector<double> light, area, ratio, all_light;
  for (std::size_t k = 0; k < spot_at_.size(); ++k)
    if (spot_at_[k] >= 0) {
      all_light.push_back(own[k].light);
      if (from_middle(found_.spots[static_cast<std::size_t>(spot_at_[k])]) > kCore * pitch_px()) continue;
      light.push_back(own[k].light), area.push_back(near[k].area_px2()), ratio.push_back(near[k].axis_ratio());
    }
  const double core_light = options_.particle_images ? quantile(all_light, 0.9) : quantile(light, 0.5);
  const double core_area = quantile(area, 0.5), core_ratio = quantile(ratio, 0.5);
  const auto least = [](const std::vector<double>& values, double middle) {  // five spreads below the median
    const double spread = (middle - quantile(values, 0.16)) / std::max(middle, 1e-300);
    return middle * (1 - std::max(kLeastLoss, 5 * spread));
  };
  const double least_area = least(area, core_area), least_ratio = least(ratio, core_ratio);
  for (std::size_t k = 0; k < spot_at_.size(); ++k) {
    if (spot_at_[k] < 0) continue;
    FoundSpot& s = found_.spots[static_cast<std::size_t>(spot_at_[k])];
    s.light = own[k].light / std::max(core_light, 1e-300);
    const auto out = own[k].centroid_px();
    s.centroid_x_px = s.predicted_x_px + out[0], s.centroid_y_px = s.predicted_y_px + out[1];
    s.area = near[k].area_px2() / std::max(core_area, 1e-300), s.axis_ratio = near[k].axis_ratio();
    s.reason = 0;
    if (s.light < kLeastLight) s.reason |= kBrightness;
    if (options_.particle_images) continue;
    if (own[k].light < kLeastOfNeighbours * near[k].light / near[k].cells) s.reason |= kBrightness;
    if (found_.overlapping) continue;
    if (near[k].area_px2() < least_area) s.reason |= kArea;
    if (near[k].axis_ratio() < least_ratio) s.reason |= kEccentricity;
  }
}

SubimageTemplate Search::fold() const {
  std::vector<std::array<double, 2>> centres;
  for (const auto& s : found_.spots)
    if (s.reason == 0) centres.push_back({s.predicted_x_px, s.predicted_y_px});
  return {image_, centres, kWindow * pitch_px()};
}

/// A white image whose gaps are not dark has overlapping sub-images; the sign of its first harmonic, that of J1 of the
/// sub-images' diameter, says whether the bright places are centres.
void Search::look_for_overlap() {
  expect(kCore * pitch_px());
  const double gap = gap_of(fold());
  if (options_.particle_images || gap < kMostGap) return;
  const std::string what = fmt::format("between sub-images it has {:.0f} % of their light, so they overlap", 100 * gap);
  if (!(start_.lens.image_f_number > 0))
    refuse(what + "; give --f-number of the lens at the array, or --dark if that is the black level, or stop down");
  const double pitches = start_.lenslets.focal_length_mm / start_.lens.image_f_number / found_.fit.lattice.pitch_mm;
  const double harmonic = std::cyl_bessel_j(
      1.0, std::numbers::pi * pitches * (start_.lenslets.shape == "hexagonal" ? 2 / std::numbers::sqrt3 : 1));
  if (std::abs(harmonic) < 0.05 || pitches < 0.9)
    refuse(
        fmt::format("{}, and at f/{:.4g} they would be {:.2f} pitches wide, which does not tell centres from borders; "
                    "stop the lens down for this image",
                    what, start_.lens.image_f_number, pitches));
  found_.overlapping = true;
  if (harmonic < 0) found_.fit.lattice = moved_by_half(found_.fit.lattice);
}

void Search::pass(double reach) {
  expect(reach);
  judge_shapes();
  const SubimageTemplate mean = fold();
  found_.diameter_px = mean.half_height_diameter_px();
  std::vector<LatticeSpot> spots;
  double intact = 0, field = 0;
  for (auto& s : found_.spots) {
    const auto match = mean.match(image_, {s.predicted_x_px, s.predicted_y_px});
    s.matched = match.found;
    s.x_px = s.predicted_x_px + match.dx_px, s.y_px = s.predicted_y_px + match.dy_px;
    field = std::max(field, from_middle(s));
    if (!s.matched) s.reason |= kBrightness;
    if (s.reason != 0) continue;
    intact = std::max(intact, from_middle(s));
    const auto at = frame_.to_mm({s.x_px, s.y_px});
    spots.push_back({s.u, s.v, at[0], at[1]});
  }
  found_.intact_radius_px = intact, found_.field_radius_px = field;
  const bool may_bend = !options_.particle_images && intact >= kReached * field;
  found_.fit = fit_lattice_as_seen(spots, found_.fit.lattice, may_bend);
  constexpr std::size_t kLeastSpots = 40;
  if (found_.fit.used < std::min(kLeastSpots, std::max<std::size_t>(found_.spots.size() / 4, 6)))
    refuse(
        fmt::format("only {} of {} sub-images within {:.0f} px of the middle are intact; take a white image with the "
                    "lens centred on the array and the exposure raised",
                    found_.fit.used, found_.spots.size(), reach));
  if (!may_bend && !options_.particle_images)
    found_.distortion_unsure = fit_lattice_as_seen(spots, found_.fit.lattice, true).parameters > found_.fit.parameters;
}

void Search::finish() {
  const double gap = gap_of(fold());
  constexpr double kMostGapAtEnd = 0.35;
  if (!found_.overlapping && gap > kMostGapAtEnd)
    refuse(
        fmt::format("the {} lattice that fits best, of {:.2f} px, leaves {:.0f} % of the light between its sub-images, "
                    "so it is none; {}",
                    start_.lenslets.shape, pitch_px(), 100 * gap,
                    options_.particle_images ? "give more particle images, or --exit-pupil-mm if it is known"
                                             : "take a white image in focus on the array's focal plane"));
  const LensletGeometry geometry(found_.fit.lattice);
  const double scatter_px = found_.fit.scatter_mm / frame_.pixel_mm;
  const double most = std::max(0.3, 6 * std::numbers::sqrt2 * scatter_px);
  for (auto& s : found_.spots) {
    const auto at = frame_.to_px(geometry.position_mm(s.u, s.v));
    s.predicted_x_px = at[0], s.predicted_y_px = at[1];
    if (s.reason == 0 && std::hypot(s.x_px - at[0], s.y_px - at[1]) > most) s.reason |= kResidual;
  }
  const double allowed = (options_.particle_images ? 0.2 : 0.06) * pitch_px();
  if (scatter_px > allowed)
    refuse(
        fmt::format("sub-images lie {:.2f} px (per axis) off the best {} lattice of {:.2f} px, and {:.2f} is too much "
                    "for a calibration; check the shape, and for moire or a moving array",
                    scatter_px, start_.lenslets.shape, pitch_px(), allowed));
}

}  // namespace

FoundLenslets find_lenslets(const GreyImage& image, const LightFieldCalibration& start, const FindOptions& options) {
  return Search(image, start, options).run();
}

}  // namespace rptv
