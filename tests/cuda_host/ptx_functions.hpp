// SPDX-License-Identifier: MIT
// What PTX opcodes mean: those that compute a value are functions, the rest is for the interpreter's loop.
#pragma once

#include <string>
#include <vector>

#include "tests/cuda_host/ptx_program.hpp"

namespace rptv::cuda_host {

/// Decodes one instruction, `parts` of its opcode at the dots; throws PtxError without a place.
void decode_ptx(const std::vector<std::string>& parts, PtxInstruction& instruction);

/// The function of an opcode that computes one value, or null.
PtxCompute ptx_integer_function(const std::string& operation, PtxType type);
PtxCompute ptx_bit_field_function(const std::string& operation, PtxType type);
PtxCompute ptx_float_function(const std::string& operation, PtxType type);
PtxCompute ptx_comparison(const std::string& relation, PtxType type);

/// cvt: `rounding` is rn, rni, rzi, rmi, rpi or empty.
std::uint64_t ptx_convert(std::uint64_t value, PtxType from, PtxType to, const std::string& rounding);

}  // namespace rptv::cuda_host
