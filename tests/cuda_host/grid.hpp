// SPDX-License-Identifier: MIT
// Runs the blocks of a launch, one after the other, in an order that a seed chooses.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "tests/cuda_host/block.hpp"

namespace rptv::cuda_host {

class Grid {
 public:
  /// Returns the fault, or an empty text. One grid runs at a time in the process.
  std::string run(dim3 blocks, const Block::Shape& shape, std::uint64_t seed, const std::function<void()>& body);

 private:
  FiberPool fibers_;
};

}  // namespace rptv::cuda_host
