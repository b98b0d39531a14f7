// SPDX-License-Identifier: MIT
// The steps of a camera calibration in their order.
#include "calibration/cameras/calibrate_cameras.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/cameras/median.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr double kWorseThanMedian = 4, kNeverDropped_px = 0.3;  // of images in the bundle
constexpr int kRounds = 3;
constexpr double kAgree_px = 10;           // farther away, a view contradicts the others
constexpr double kAgreeBehindGlass = 0.1;  // of the image's width, where lenses were fitted as if there were none

void remove_dropped(BoardSet& set, const std::vector<DroppedView>& dropped) {
  std::erase_if(set.images, [&](const BoardView& image) {
    return std::any_of(dropped.begin(), dropped.end(),
                       [&](const DroppedView& d) { return d.camera == image.camera && d.view == image.view; });
  });
}

/// Target poses in the first camera's frame, each by the camera that saw most of it.
std::vector<std::optional<CameraPose>> target_poses(const BoardSet& set, const std::vector<SingleCamera>& singles,
                                                    const std::vector<CameraPose>& cameras) {
  std::vector<std::optional<CameraPose>> targets(set.views.size());
  std::vector<std::size_t> most(set.views.size(), 0);
  for (const auto& image : set.images) {
    const auto& pose = singles[image.camera].target[image.view];
    if (!pose || image.seen.size() <= most[image.view]) continue;
    most[image.view] = image.seen.size();
    targets[image.view] = after(inverse(cameras[image.camera]), *pose);
  }
  return targets;
}

std::vector<DroppedView> worst_images(const BoardSet& set, const BundleResult& result) {
  const std::vector<double> rms = image_rms_px(set, result);
  const double middle = median(rms);
  std::vector<DroppedView> worst;
  for (std::size_t i = 0; i < rms.size(); ++i)
    if (rms[i] > std::max(kWorseThanMedian * middle, kNeverDropped_px))
      worst.push_back({set.images[i].camera, set.images[i].view,
                       fmt::format("rms {:.3f} px in the bundle, the median is {:.3f} px", rms[i], middle)});
  return worst;
}

}  // namespace

std::vector<double> image_rms_px(const BoardSet& set, const BundleResult& result) {
  std::vector<double> sum(set.images.size(), 0), count(set.images.size(), 0);
  for (const auto& r : result.residuals)
    sum[r.image] += r.error_px[0] * r.error_px[0] + r.error_px[1] * r.error_px[1], ++count[r.image];
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = count[i] > 0 ? std::sqrt(sum[i] / count[i]) : 0;
  return sum;
}

CameraCalibration calibrate_cameras(const BoardSet& set, const CameraCalibrationOptions& options) {
  CameraCalibration c;
  c.used = set;
  const bool glass = !options.stack.interfaces.empty() || !options.windows.empty();
  SingleCameraOptions by_itself = options.single;
  by_itself.behind_glass = glass;
  for (std::size_t k = 0; k < set.cameras.size(); ++k) {
    c.singles.push_back(fit_single_camera(set, k, by_itself));
    c.dropped.insert(c.dropped.end(), c.singles.back().dropped.begin(), c.singles.back().dropped.end());
  }
  remove_dropped(c.used, c.dropped);
  c.graph = link_cameras(c.used, c.singles, glass ? kAgreeBehindGlass * set.cameras[0].width_px : kAgree_px);
  check_graph(c.used, c.singles, c.graph);
  Bundle bundle;
  for (const auto& single : c.singles) bundle.lenses.push_back(single.lens);
  bundle.cameras = register_cameras(c.used, c.graph);
  bundle.stack = options.stack, bundle.windows = options.windows;
  for (int round = 0;; ++round) {
    bundle.targets = target_poses(c.used, c.singles, bundle.cameras);
    BundleOptions adjust;
    adjust.fit_k3 = options.single.fit_k3, adjust.fit_stack = options.fit_stack;
    adjust.frame_view = options.world_view;
    c.result = adjust_bundle(c.used, bundle, adjust);
    const auto worst =
        options.single.drop_outliers && round < kRounds ? worst_images(c.used, c.result) : std::vector<DroppedView>{};
    if (worst.empty()) break;
    c.dropped.insert(c.dropped.end(), worst.begin(), worst.end());
    remove_dropped(c.used, worst);
    bundle.lenses = c.result.bundle.lenses, bundle.cameras = c.result.bundle.cameras;
  }
  if (options.world_view) {
    const auto& world = c.result.bundle.targets[*options.world_view];
    if (!world)
      throw Error(ExitCode::bad_data, fmt::format("view {} was to give the frame and no camera sees the target well "
                                                  "enough in it; name another",
                                                  set.views[*options.world_view]));
    c.result.bundle = in_frame(c.result.bundle, CameraPose(*world));
  }
  for (std::size_t k = 0; k < set.cameras.size(); ++k)
    c.rig.cameras.push_back({set.cameras[k].name, CameraModel(c.result.bundle.lenses[k], c.result.bundle.cameras[k],
                                                              stack_of(c.result.bundle, k), set.cameras[k].name)});
  return c;
}

}  // namespace rptv
