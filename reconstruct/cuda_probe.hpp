// SPDX-License-Identifier: MIT
// Whether this process can compute on a GPU, and why not.
#pragma once

#include <string>

namespace rptv {

/// What was found. `device` is the CUDA number of the first device that this build has code for.
struct CudaProbe {
  bool usable = false;
  int device = -1;
  std::string text;  ///< usable: the device's name and memory; else why not, and what would help. One line
};

/// Asks driver and devices; set-up only, may take a second, any thread. Never throws: what fails is in `text`. In a
/// build without CUDA it says that.
CudaProbe probe_cuda();

}  // namespace rptv
