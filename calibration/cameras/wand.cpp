// SPDX-License-Identifier: MIT
// Each end of the rod in each view is a target of one point; rods tie them in pairs.
#include "calibration/cameras/wand.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/cameras/median.hpp"
#include "calibration/cameras/rig_accuracy.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr std::size_t kLeast = 10;  // rods, and ends in each camera
constexpr double kMostLengthError = 0.1;

/// View 2·v + e of the result is end e in view v.
BoardSet ends_of(const BoardSet& seen) {
  BoardSet ends{{Point3{}}, seen.cameras, {}, {}};
  for (const auto& view : seen.views)
    for (const char* end : {" first end", " second end"}) ends.views.push_back(view + end);
  for (const auto& image : seen.images)
    for (const auto& s : image.seen)
      ends.images.push_back({image.camera, 2 * image.view + s.point, image.origin, {{0, s.pixel}}});
  return ends;
}

/// Where ends are, by the cameras that see them; none for ends that fewer than two see.
std::vector<std::optional<CameraPose>> places_of(const BoardSet& ends, const std::vector<CameraModel>& cameras) {
  std::vector<std::vector<Sighting>> sightings(ends.views.size());
  for (const auto& image : ends.images) sightings[image.view].push_back({&cameras[image.camera], image.seen[0].pixel});
  std::vector<std::optional<CameraPose>> places(ends.views.size());
  for (std::size_t v = 0; v < places.size(); ++v)
    if (const auto point = triangulate(sightings[v])) places[v] = CameraPose{CameraPose{}.rotation, *point};
  return places;
}

double length_of(const std::vector<std::optional<CameraPose>>& places, const Rod& rod) {
  return norm(places[rod.second]->translation_mm - places[rod.first]->translation_mm);
}

double rms_error_mm(const std::vector<std::optional<CameraPose>>& places, const std::vector<Rod>& rods) {
  double sum = 0;
  for (const auto& rod : rods) sum += std::pow(length_of(places, rod) - rod.length_mm, 2);
  return std::sqrt(sum / static_cast<double>(rods.size()));
}

}  // namespace

WandCalibration calibrate_with_wand(const Rig& start, const BoardSet& seen, double length_mm, bool fit_lenses) {
  const auto refuse = [](const std::string& text) { throw Error(ExitCode::bad_data, text); };
  Bundle bundle;
  for (const auto& camera : start.cameras) {
    bundle.lenses.push_back(camera.model.intrinsics()), bundle.cameras.push_back(camera.model.pose());
    bundle.stack = camera.model.stack();
  }
  const BoardSet ends = ends_of(seen);
  bundle.targets = places_of(ends, models_of(bundle));
  BundleOptions options;
  options.fit_lenses = fit_lenses, options.single_points = true;
  for (std::size_t v = 0; v < ends.views.size(); v += 2)
    if (bundle.targets[v] && bundle.targets[v + 1]) options.rods.push_back({v, v + 1, length_mm});
  WandCalibration wand;
  wand.rods = options.rods.size();
  if (wand.rods < kLeast)
    refuse(
        fmt::format("two or more cameras see both ends of the rod in {} views; wave it through the whole volume, {} "
                    "views at least",
                    wand.rods, kLeast));
  for (std::size_t c = 0; c < start.cameras.size(); ++c) {
    const auto count =
        static_cast<std::size_t>(std::count_if(ends.images.begin(), ends.images.end(), [&](const BoardView& i) {
          return i.camera == c && bundle.targets[i.view].has_value();
        }));
    if (count < kLeast)
      refuse(fmt::format("camera {} sees {} ends of the rod together with others; it needs {}", start.cameras[c].name,
                         count, kLeast));
  }
  std::vector<double> lengths;
  for (const auto& rod : options.rods) lengths.push_back(length_of(bundle.targets, rod));
  const double middle = median(lengths);
  if (std::abs(middle / length_mm - 1) > kMostLengthError)
    refuse(
        fmt::format("with the rig as it is the rod is {:.2f} mm long and {:.6g} were given; check the length, the "
                    "names of the cameras and which end is which",
                    middle, length_mm));
  wand.before_rms_mm = rms_error_mm(bundle.targets, options.rods);
  wand.result = adjust_bundle(ends, bundle, options);
  wand.volume = volume_accuracy(ends, wand.result);
  const auto models = models_of(wand.result.bundle);
  const auto places = places_of(ends, models);
  wand.rms_mm = rms_error_mm(places, options.rods);
  for (const auto& rod : options.rods)
    wand.largest_mm = std::max(wand.largest_mm, std::abs(length_of(places, rod) - length_mm));
  for (std::size_t c = 0; c < models.size(); ++c) wand.rig.cameras.push_back({start.cameras[c].name, models[c]});
  return wand;
}

}  // namespace rptv
