// SPDX-License-Identifier: MIT
// `rapidptv bench --cuda`.
#pragma once

#include <string>
#include <vector>

#include "core/error.hpp"

namespace rptv {

struct CudaBenchOptions {
  std::string config;
  std::vector<std::string> set;
  int rounds = 1;     ///< a frame set
  bool json = false;  ///< on stdout; the table then goes to stderr
};

/// Prints the table, on stdout. Throws Error(unavailable) with the reason where there is no usable device, and what
/// load_config(), make_source() and make_reconstructor() throw.
ExitCode bench_cuda(const CudaBenchOptions& options);

}  // namespace rptv
