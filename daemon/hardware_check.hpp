// SPDX-License-Identifier: MIT
// The configured cameras on trial: they run for a few seconds, and what each of them gave is told.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "proto/status.hpp"

namespace rptv {

struct HardwareCheck {
  struct Camera {
    CameraReport report;
    double rate_hz = 0;             ///< of the frames that came, from its first one on; 0 for less than two
    std::vector<LossCount> losses;  ///< place: the camera's name
  };
  std::vector<Camera> cameras;
  std::uint64_t sets = 0;  ///< frames of all cameras that were paired; of one camera: its frames
  double elapsed_s = 0;
  std::vector<std::string> warnings;  ///< one line each, with the likely cause or the next step
  std::string problem;                ///< why a run would give nothing, one line; empty when it would
};

/// Opens the cameras of `config` and takes their frames in as a run does, for `duration_s`, without reconstruction and
/// without publishing. Blocks so long; set-up thread. Throws Error: configuration (a replay has no hardware; see
/// SyncSettings), unavailable (a camera is absent or taken).
HardwareCheck check_hardware(const Config& config, double duration_s);

/// Some lines per camera, then the warnings.
std::string to_text(const HardwareCheck& check);
/// {"ok", "problem", "elapsed_s", "sets", "cameras": [{"camera", "rate_hz", "losses": {cause: count}}, …], "warnings"}
std::string to_json(const HardwareCheck& check);

}  // namespace rptv
