// SPDX-License-Identifier: MIT
// Writes a simulated run as a folder that the daemon can replay and a score can judge.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "simulation/scenario.hpp"

namespace rptv {

struct SimulatedRunOptions {
  std::filesystem::path folder;  ///< created when missing; files of an earlier run are replaced
  unsigned threads = 0;          ///< 0: one per processor
};

struct SimulatedRunReport {
  std::uint64_t frames = 0;
  double particles_per_frame = 0;  ///< lit, mean
  double in_view_per_frame = 0;    ///< of those, whole image on the sensor
  std::uint64_t bytes = 0;         ///< of the frames' files
  std::uint64_t rays = 0;          ///< traced for the frames
  double frames_elapsed_s = 0;     ///< of that: the frames
  double elapsed_s = 0;
};

/// Writes into the folder: frames/frame_00000.png … and frames/frames.csv (frame,t); truth.csv (tracks table +
/// in_view, image positions, light); volume_truth.csv (object and image points); white.png, white_stopped.png,
/// dark.png; background.png (mean, no noise); calibration.toml; scenario.toml; rig.toml, ready for `rapidptv run`.
/// Draws a progress bar on a terminal. The same scenario gives the same files whatever the number of threads. Throws
/// Error.
SimulatedRunReport write_simulated_run(const ScenarioSettings& scenario, const SimulatedRunOptions& options);

/// A configuration for `rapidptv run` in the folder of a simulated run; paths count from that folder.
std::string rig_toml(const ScenarioSettings& scenario);
/// The same for a run of a rig of so many views.
std::string views_rig_toml(const ScenarioSettings& scenario, std::size_t views);

/// Names of the files in the folder.
struct SimulatedRunFiles {
  explicit SimulatedRunFiles(const std::filesystem::path& folder);
  std::filesystem::path frames, frame_times, truth, volume_truth, white, white_stopped, dark, background, calibration,
      scenario, rig;
  std::filesystem::path frame(std::uint64_t index) const;
};

}  // namespace rptv
