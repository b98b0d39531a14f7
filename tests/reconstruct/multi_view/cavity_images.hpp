// SPDX-License-Identifier: MIT
// The shared images of a real cavity, the settings that OpenPTV's own parameter files give for them, and its rig as
// published and as fitted to particles of the one frame that nothing here is judged by.
#pragma once

#include <fmt/format.h>

#include <cstdlib>
#include <optional>

#include "calibration/cameras/known_points.hpp"
#include "calibration/cameras/openptv.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv::testing {

inline std::optional<std::filesystem::path> shared_folder(const std::string& name) {
  const char* root = std::getenv("RPTV_SHARED_DATA");
  if (root == nullptr || !std::filesystem::exists(std::filesystem::path(root) / name)) return {};
  return std::filesystem::path(root) / name;
}

/// Frames 10000 to 10004 of four cameras; OpenPTV judged 10001 to 10004.
class CavityImages {
 public:
  explicit CavityImages(std::filesystem::path folder) : folder_(std::move(folder)) {
    for (int camera = 1; camera <= 4; ++camera) backgrounds_.push_back(darkest(camera));
  }
  const FrameSet& load(int frame) {
    for (std::size_t c = 0; c < 4; ++c) frames_.load(c, image(static_cast<int>(c) + 1, frame));
    return frames_.set();
  }
  std::vector<MultiViewCamera> cameras() const {
    auto cameras = frames_.views("cam", 1);
    for (std::size_t c = 0; c < 4; ++c) cameras[c].background = backgrounds_[c].view();
    return cameras;
  }
  /// targ_rec.par: grey 9 above the background, 4 px; criteria.par: z of -20 to 20 mm, and in x and y what cameras see.
  static MultiViewSettings settings() {
    MultiViewSettings settings;
    settings.detector.threshold = 9, settings.detector.noise_grey = 2, settings.detector.threshold_sigmas = 0;
    settings.detector.radius_px = 1, settings.detector.min_area_px = 4;
    settings.volume_x_mm = {-66, 60}, settings.volume_y_mm = {-40, 60}, settings.volume_z_mm = {-20, 20};
    settings.calibration_px = 0.5;
    return settings;
  }
  Rig published_rig() const { return import_openptv(folder_).rig; }
  /// Poses fitted to bright particles of frame 10000, by ever smaller tolerances: the published ones miss them by 3 px.
  Rig fitted_rig() {
    Rig rig = published_rig();
    MultiViewSettings settings = CavityImages::settings();
    settings.detector.threshold = 25, settings.min_views = 4;
    Particles found(16384);
    for (const double tolerance_px : {6.0, 5.0, 4.0, 3.0, 2.0, 1.5}) {
      settings.tolerance_px = tolerance_px;
      MultiView multi_view(settings, rig, cameras());
      multi_view.reconstruct(load(0), found);
      std::vector<KnownPoint> seen;
      for (std::size_t c = 0; c < 4; ++c)
        for (std::size_t i = 0; i < found.size(); ++i) {
          const Point3 at{found.x_mm[i], found.y_mm[i], found.z_mm[i]};
          const auto pixel = nearest(multi_view.detections()[c], rig.cameras[c].model.project(at).value());
          if (pixel) seen.push_back({c, at, *pixel});
        }
      rig = fit_known_points(rig, seen, CameraFreedom::pose, "particles of frame 10000").rig;
    }
    return rig;
  }

  static std::optional<Pixel> nearest(const Detections& seen, const Pixel& pixel) {
    std::optional<Pixel> best;
    for (std::size_t i = 0; i < seen.size(); ++i)
      if (!best || distance({seen.x_px[i], seen.y_px[i]}, pixel) < distance(*best, pixel))
        best = Pixel{seen.x_px[i], seen.y_px[i]};
    return best;
  }
  static double distance(const Pixel& a, const Pixel& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

 private:
  std::filesystem::path image(int camera, int frame) const {
    return folder_ / fmt::format("images/cam{}_{}.tif", camera, 10000 + frame);
  }
  /// The darkest that a pixel was in the five frames: what is left when particles move.
  DecodedImage darkest(int camera) const {
    DecodedImage dark(image(camera, 0));
    for (int frame = 1; frame < 5; ++frame) {
      const DecodedImage next(image(camera, frame));
      std::transform(dark.bytes.begin(), dark.bytes.end(), next.bytes.begin(), dark.bytes.begin(),
                     [](std::byte a, std::byte b) { return std::min(a, b); });
    }
    return dark;
  }

  std::filesystem::path folder_;
  CameraFrames frames_{{1280, 1024, 1}, 4};
  std::vector<DecodedImage> backgrounds_;
};

}  // namespace rptv::testing
