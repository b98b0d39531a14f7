// SPDX-License-Identifier: MIT
// Which vector instructions this processor has; loops that are compiled several times choose by it at run time.
#pragma once

#include <cstdint>

namespace rptv {

/// In order of preference. Every set gives the same results, bit for bit; a test runs all that the machine has.
enum class InstructionSet : std::uint8_t { portable, avx2, avx512 };

/// The best that this processor and system have: avx2 means AVX2 and FMA, avx512 means F, BW, VL and AVX2 beside it.
inline InstructionSet best_instruction_set() noexcept {
#if defined(__x86_64__)
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return InstructionSet::portable;
  const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("popcnt");
  return wide ? InstructionSet::avx512 : InstructionSet::avx2;
#else
  return InstructionSet::portable;
#endif
}

constexpr const char* name_of(InstructionSet set) noexcept {
  return set == InstructionSet::avx512 ? "AVX-512" : set == InstructionSet::avx2 ? "AVX2" : "portable";
}

}  // namespace rptv
