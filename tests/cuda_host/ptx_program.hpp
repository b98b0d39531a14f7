// SPDX-License-Identifier: MIT
// A kernel in PTX, decoded for the interpreter. Source: NVIDIA, PTX ISA, version 9.0.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/cuda_host/ptx_instruction.hpp"

namespace rptv::cuda_host {

/// An array of shared memory; its addresses begin at `window`, where nothing else lies.
struct PtxShared {
  std::string name;
  std::size_t size_bytes;  // 0: dynamic
  std::size_t alignment_bytes;
  std::uint64_t window;
};

struct PtxParameter {
  std::string name;
  std::size_t offset_bytes, size_bytes;
};

struct PtxKernel {
  std::string name, file;
  std::vector<PtxParameter> parameters;  // as they lie in one buffer
  std::size_t parameter_bytes = 0;
  std::vector<PtxShared> shared;
  std::vector<PtxInstruction> instructions;
  std::size_t registers = 0;
  std::vector<std::uint64_t> constants;  // numbers of instructions; they follow the registers
};

inline constexpr int kPtxWindowBits = 20;                    // of one shared array's addresses
inline constexpr std::uint64_t kPtxParameters = 1ull << 31;  // where addresses of parameters begin
inline constexpr std::uint64_t kPtxGlobal = 1ull << 32;      // below: not global memory

/// What the interpreter does not know, or does not want: "file:line: what".
struct PtxError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Makes registers of numbers, and plain instructions of those that can be.
void assign_slots(PtxKernel& kernel);

/// All kernels of a file's text.
std::vector<PtxKernel> parse_ptx(const std::string& text, const std::string& file);

}  // namespace rptv::cuda_host
