// SPDX-License-Identifier: MIT
// What a configuration asks of the machine: what its cameras send and what it writes.
#pragma once

#include <filesystem>
#include <vector>

#include "daemon/config.hpp"
#include "daemon/doctor.hpp"

namespace rptv {

struct DoctorPlan {
  std::vector<CameraLoad> cameras;                    ///< empty for a replay
  std::vector<std::filesystem::path> output_folders;  ///< each once
  double output_bytes_per_second = 0;                 ///< when every frame is full; 0: not known
  std::vector<Finding> findings;                      ///< cameras that could not be asked
};

/// Opens the source for a moment to learn sizes and rates; one that cannot be opened is a finding, not an error.
DoctorPlan plan_of(const Config& config);

}  // namespace rptv
