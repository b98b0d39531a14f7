// SPDX-License-Identifier: MIT
// The rig of the first tracking challenge at a given density, rendered in memory, with what a reconstruction needs to
// know.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "calibration/cameras/rig.hpp"
#include "core/frame.hpp"
#include "core/particles.hpp"
#include "reconstruct/multi_view/view_setup.hpp"
#include "simulation/render_views.hpp"
#include "simulation/score.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"
#include "tracking/linker_settings.hpp"

namespace rptv::bench {

/// The shipped scenario lpt_challenge with `per_pixel` particles per pixel of a sensor, of whose sides `sensor_part` is
/// simulated.
class LptScene {
 public:
  LptScene(double per_pixel, double sensor_part);

  /// Images of that frame, valid until the next call.
  FrameSet& frames(std::uint64_t frame);
  /// Of the particles in view of the last frame.
  const std::vector<TruthRow>& truth() const { return truth_; }
  /// Within one voxel (0.06 mm, one pixel) on each axis.
  DetectionScore judge(const Particles& particles) const;

  /// As `rapidptv simulate` writes them into rig.toml.
  MultiViewSettings settings() const;
  LinkerSettings linker_settings() const;
  std::int64_t time_ns(std::uint64_t frame) const { return std::llround(1e9 * tracers_.time_s(frame)); }
  const Rig& rig() const { return rig_; }
  std::vector<MultiViewCamera> cameras() const { return images_.views("cam", 0); }
  double px_per_mm() const { return 10000.0 / 600; }

 private:
  Rig rig_;
  ScenarioSettings scenario_;
  Tracers tracers_;
  std::vector<ViewRenderer> renderers_;
  testing::CameraFrames images_;
  std::uint64_t frame_ = 0;
  std::vector<TruthRow> truth_;
};

}  // namespace rptv::bench
