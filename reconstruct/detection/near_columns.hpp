// SPDX-License-Identifier: MIT
// Which of some pixels have columns near a given one, many at once.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/instruction_set.hpp"
#include "reconstruct/detection/lit_maxima.hpp"

namespace rptv {

/// Bit k of the answer: the columns of pixels[k] and x differ by at most `reach`; 0 from k = count on, which is at
/// most 64. Any thread.
using NearColumns = std::uint64_t (*)(const PixelIndex* pixels, std::size_t count, std::int32_t x,
                                      std::int32_t reach) noexcept;

/// The way that is quickest with these instructions; all give the same.
NearColumns near_columns(InstructionSet set = best_instruction_set()) noexcept;

}  // namespace rptv
