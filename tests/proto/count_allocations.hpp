// SPDX-License-Identifier: MIT
// How often operator new was called in this process, libraries included.
#pragma once

#include <cstdint>

namespace rptv {

std::uint64_t allocations_so_far() noexcept;

}  // namespace rptv
