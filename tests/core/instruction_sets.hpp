// SPDX-License-Identifier: MIT
// All instruction sets that this machine can test.
#pragma once

#include <vector>

#include "core/instruction_set.hpp"

namespace rptv::testing {

inline std::vector<InstructionSet> sets_here() {
  std::vector<InstructionSet> sets;
  for (const auto set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512})
    if (set <= best_instruction_set()) sets.push_back(set);
  return sets;
}

}  // namespace rptv::testing
