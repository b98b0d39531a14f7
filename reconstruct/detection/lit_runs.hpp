// SPDX-License-Identifier: MIT
// Lit pixels as runs along rows: what connected blobs are made of.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.hpp"
#include "core/instruction_set.hpp"
#include "reconstruct/lit_pixels.hpp"

namespace rptv {

/// Lit pixels first_x … end_x - 1 of row y, with a dark one (or the border) on either side.
struct LitRun {
  std::uint32_t y, first_x, end_x;
  bool operator==(const LitRun&) const = default;
};

/// Fills `runs`, up to its capacity, in raster order, and returns how many there are: more than runs.size() means that
/// the last ones were left out. `image` has limit.size() pixels. No allocation; any thread.
std::size_t find_lit_runs(const ImageView& image, const DarkLimit& limit, std::vector<LitRun>& runs,
                          InstructionSet set = best_instruction_set()) noexcept;

}  // namespace rptv
