// SPDX-License-Identifier: MIT
// A small recording by four cameras, its rig and its configuration, and what may be wrong with them.
#pragma once

#include <filesystem>
#include <string>
#include <utility>

#include "calibration/cameras/rig.hpp"
#include "tests/daemon/run_binary.hpp"
#include "tests/proto/place.hpp"
#include "tests/reconstruct/multi_view/camera_frames.hpp"

namespace rptv::testing {

/// Two frames of four cameras in a folder, the rig, and the configuration that replays them.
class PaintedRecording {
 public:
  PaintedRecording() {
    ViewScene scene = make_scene(4, 40, 0);
    std::filesystem::create_directory(place_.file("frames"));
    for (int frame = 0; frame < 2; ++frame) {
      paint(scene, frames_);
      for (std::size_t c = 0; c < 4; ++c)
        write_png(place_.file("frames/cam" + std::to_string(c) + "_" + std::to_string(frame) + ".png"),
                  frames_.set().frames[c].view());
    }
    for (std::size_t c = 0; c < 4; ++c) scene.rig.cameras[c].name = "cam" + std::to_string(c);
    write_rig(scene.rig, place_.file("cameras.toml"));
    place_.write("run.toml",
                 "[replay]\npath = \"frames\"\nrate_hz = 100.0\nspeed = 0.0\n"
                 "[intake]\npolicy = \"lossless\"\n[reconstruction]\nkind = \"multi_view\"\n"
                 "[multi_view]\nrig = \"cameras.toml\"\nmax_particles = 1000\n"
                 "[publisher]\nendpoint = \"" +
                     place_.ipc() + "\"\n");
  }
  std::string file(const std::string& name) const { return place_.file(name); }
  Said check(const std::string& method = "detections") const {
    return run_rapidptv({"check", "--config", file("run.toml"), "--set", "multi_view.method=" + method});
  }
  /// Every pixel of a camera's image.
  void blank(const std::string& camera, int grey, const std::string& frame = "0") {
    frames_.fill(0, grey);
    write_png(place_.file("frames/" + camera + "_" + frame + ".png"), frames_.set().frames[0].view());
  }
  void move_all_in_rig() {
    Rig rig = read_rig(file("cameras.toml"));
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      CameraPose pose = rig.cameras[c].model.pose();
      pose.translation_mm[1] += c % 2 == 0 ? 5 : -5;
      rig.cameras[c].model = CameraModel(rig.cameras[c].model.intrinsics(), pose);
    }
    write_rig(rig, place_.file("cameras.toml"));
  }
  void calibrate_for(int width_px, int height_px) {
    Rig rig = read_rig(file("cameras.toml"));
    CameraIntrinsics lens = rig.cameras[0].model.intrinsics();
    lens.width_px = width_px, lens.height_px = height_px;
    rig.cameras[0].model = CameraModel(lens, rig.cameras[0].model.pose());
    write_rig(rig, place_.file("cameras.toml"));
  }
  void swap_in_rig(std::size_t one, std::size_t other) {
    Rig rig = read_rig(file("cameras.toml"));
    std::swap(rig.cameras[one].name, rig.cameras[other].name);
    write_rig(rig, place_.file("cameras.toml"));
  }
  Said run() const { return run_rapidptv({"run", "--config", file("run.toml")}); }
  Said reconstruct() const {
    return run_rapidptv({"reconstruct", "--config", file("run.toml"), "-o", file("table.csv")});
  }

 private:
  Place place_;
  CameraFrames frames_{{1920, 1200, 1}, 4};
};

}  // namespace rptv::testing
