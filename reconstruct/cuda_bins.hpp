// SPDX-License-Identifier: MIT
// Items sorted into bins, as they lie on the device.
#pragma once

#include <cstdint>

namespace rptv {

/// Bin b's items are entry[start[b]] to entry[start[b + 1]]; device memory.
struct CudaBins {
  std::uint32_t* start;        ///< two more than bins
  std::uint32_t *bin, *entry;  ///< as many as items
};

inline constexpr std::uint32_t kNoBin = 0xFFFFFFFFU;  ///< of an item that is left out

}  // namespace rptv
