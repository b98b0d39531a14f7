// SPDX-License-Identifier: MIT
// Four cameras before a board that is held to all sides: what they see of it, with noise, and the truth.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>
#include <utility>

#include "calibration/cameras/board.hpp"
#include "calibration/cameras/bundle_adjust.hpp"
#include "calibration/cameras/camera_graph.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "tests/calibration/cameras/sample_cameras.hpp"

namespace rptv {

inline Board small_board() {
  Board board;
  board.columns = 7, board.rows = 6, board.square_mm = 20, board.marker_mm = 15;
  return board;
}

/// Cameras about 1 m away on the rig's negative z side; the first one's frame is the rig's. Views tilt by up to
/// `tilt_rad`. Pixels have normal noise of `noise_px`.
struct BoardRig {
  Bundle truth;
  BoardSet set;

  explicit BoardRig(std::vector<Point3> target_mm, std::size_t views = 10, double noise_px = 0.005,
                    double tilt_rad = 0.6, const RefractiveStack& stack = {},
                    const std::vector<RefractiveStack>& windows = {}) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    std::normal_distribution<double> noise(0, 1);
    const CameraPose middle = looking_at({0, 0, -1000}, {0, 0, 0}, 0);
    for (const auto& [x, y] : {std::pair{-300.0, -200.0}, {300.0, -180.0}, {-280.0, 210.0}, {320.0, 190.0}}) {
      CameraIntrinsics lens{
          1280, 1024, 3000 + 20 * any(random), 3000 + 20 * any(random), 640 + 10 * any(random), 512 + 10 * any(random)};
      lens.k1 = 0.1 * any(random), lens.k2 = 0.1 * any(random), lens.p1 = 1e-3 * any(random),
      lens.p2 = 1e-3 * any(random);
      truth.lenses.push_back(lens);
      truth.cameras.push_back(looking_at({x, y, -950}, {0, 0, 0}, 0.1 * any(random)));
      set.cameras.push_back({"cam" + std::to_string(set.cameras.size()), lens.width_px, lens.height_px});
    }
    Point3 centre{};
    for (const auto& p : target_mm) centre = centre + (1.0 / static_cast<double>(target_mm.size())) * p;
    for (std::size_t v = 0; v < views; ++v) {
      const Point3 at{40 * any(random), 40 * any(random), 40 * any(random)};
      const double a = tilt_rad * any(random), b = tilt_rad * any(random);
      const CameraPose tilted = looking_at({std::sin(a), std::sin(b), -1}, {0, 0, 0}, 0.3 * any(random));
      const Matrix3 rotation = transpose(tilted.rotation) * middle.rotation;
      truth.targets.push_back(CameraPose{rotation, at - rotation * centre});
      set.views.push_back(std::to_string(v));
    }
    truth.stack = stack, truth.windows = windows;
    set.target_mm = std::move(target_mm);
    for (std::size_t c = 0; c < truth.cameras.size(); ++c)
      for (std::size_t v = 0; v < views; ++v) {
        const CameraModel model(truth.lenses[c], truth.cameras[c], stack_of(truth, c));
        BoardView image{c, v, set.cameras[c].name + "_" + set.views[v], {}};
        for (std::size_t k = 0; k < set.target_mm.size(); ++k)
          if (const auto at =
                  model.project(truth.targets[v]->rotation * set.target_mm[k] + truth.targets[v]->translation_mm);
              at && model.in_image(*at))
            image.seen.push_back({k, {(*at)[0] + noise_px * noise(random), (*at)[1] + noise_px * noise(random)}});
        set.images.push_back(std::move(image));
      }
  }

  BoardView& image(std::size_t camera, std::size_t view) { return set.images[camera * set.views.size() + view]; }
  /// True pose of a camera in the first one's frame.
  CameraPose from_first(std::size_t camera) const { return after(truth.cameras[camera], inverse(truth.cameras[0])); }
};

/// The message of the Error that `action` throws; empty when it throws none.
inline std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace rptv
