// SPDX-License-Identifier: MIT
// A recording by four cameras, and a rig whose third camera was pushed after its calibration.
#pragma once

#include <filesystem>
#include <string>

#include "calibration/cameras/rig.hpp"
#include "tests/proto/place.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"

namespace rptv::testing {

/// A camera shifted along its axes, 0.58 mm: about 2.6 px for the rig of make_rig().
inline Rig push_camera(Rig rig, std::size_t camera) {
  CameraPose pose = rig.cameras[camera].model.pose();
  pose.translation_mm[0] += 0.5, pose.translation_mm[1] -= 0.3;
  rig.cameras[camera].model = CameraModel(rig.cameras[camera].model.intrinsics(), pose);
  return rig;
}

/// Images of two instants, cam0_0.png to cam3_1.png, in frames(); the rigs as true.toml and rig.toml.
class PushedRig {
 public:
  PushedRig() {
    std::filesystem::create_directory(frames());
    for (unsigned instant = 0; instant < 2; ++instant) {
      ViewScene scene = make_scene(4, 800, 0, 0, false, 5 + instant);
      paint(scene, frames_);
      for (std::size_t c = 0; c < 4; ++c)
        write_png(frames() + "/cam" + std::to_string(c) + "_" + std::to_string(instant) + ".png",
                  frames_.set().frames[c].view());
      rig = scene.rig;
    }
    for (std::size_t c = 0; c < 4; ++c) rig.cameras[c].name = "cam" + std::to_string(c);
    write_rig(rig, file("true.toml"));
    write_rig(push_camera(rig, 2), file("rig.toml"));
  }
  std::string frames() const { return file("frames"); }
  std::string file(const std::string& name) const { return place_.file(name); }
  std::string ipc() const { return place_.ipc(); }

  Rig rig;

 private:
  Place place_;
  CameraFrames frames_{{1920, 1200, 1}, 4};
};

}  // namespace rptv::testing
