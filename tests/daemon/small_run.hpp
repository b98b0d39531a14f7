// SPDX-License-Identifier: MIT
// A small simulated recording in a folder of its own, and the configuration that replays it.
#pragma once

#include <filesystem>
#include <string>

#include "daemon/config.hpp"
#include "daemon/simulated_run.hpp"

namespace rptv::testing {

/// 40 frames of 256 × 256 px with some 12 particles; removed by the destructor. The images are made once per object.
class SmallRun {
 public:
  explicit SmallRun(std::int64_t frames = 40) {
    std::string name = "/tmp/rapidptv-run-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
    ScenarioSettings scenario;
    scenario.frames = frames;
    scenario.camera.width_px = scenario.camera.height_px = 256;
    scenario.seeding.particles = 120;
    write_simulated_run(scenario, {.folder = folder_, .threads = 2});
  }
  ~SmallRun() { std::filesystem::remove_all(folder_); }
  SmallRun(const SmallRun&) = delete;
  SmallRun& operator=(const SmallRun&) = delete;

  const std::filesystem::path& folder() const { return folder_; }
  /// As fast as possible without loss, one thread of reconstruction, a socket in the folder.
  Config config() const {
    Config config = load_config(SimulatedRunFiles(folder_).rig);
    config.replay.speed = 0;
    config.intake.policy = "lossless";
    config.light_field.threads = 1;
    config.linker.max_particles = config.light_field.max_particles = 512;
    config.linker.max_tracks = 1024;
    config.publisher.endpoint = "ipc://" + (folder_ / "tracks.sock").string();
    return config;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace rptv::testing
