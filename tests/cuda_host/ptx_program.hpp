// SPDX-License-Identifier: MIT
// A kernel in PTX, decoded for the interpreter. Source: NVIDIA, PTX ISA, version 9.0.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace rptv::cuda_host {

/// What PTX calls a fundamental type: u, s, b (bits), f or p (predicate), and its width.
struct PtxType {
  char kind = 'b';
  std::uint8_t bits = 32;
  std::size_t bytes() const { return bits / 8u; }
};

enum class PtxOperandKind : std::uint8_t { kRegister, kNumber, kSpecial, kAddress, kVector, kNowhere };

struct PtxOperand {
  PtxOperandKind kind = PtxOperandKind::kNowhere;
  bool negated = false;              // of a predicate
  std::int32_t base = -1;            // register, special register, or the register that an address adds to
  std::uint64_t number = 0;          // immediate bits, or what an address adds to its register
  std::vector<PtxOperand> elements;  // of a vector
};

/// A pure function of up to three values in the low bits of 64 (or four of 32: the last in the third's high half).
using PtxCompute = std::uint64_t (*)(std::uint64_t a, std::uint64_t b, std::uint64_t c);

enum class PtxAction : std::uint8_t {
  kCompute,
  kConvert,
  kMove,
  kLoad,
  kStore,
  kAtomic,
  kBranch,
  kExit,
  kBarrier,
  kWarpBarrier,
  kVote,
  kShuffle,
  kFence,
  kTrap,
};

enum class PtxSpace : std::uint8_t { kGeneric, kGlobal, kShared, kParameter };

struct PtxInstruction {
  PtxAction action{};
  std::int32_t guard = -1;  // predicate register; -1: always
  bool guard_negated = false;
  PtxCompute compute = nullptr;
  PtxType type, from_type;
  PtxSpace space{};
  std::string mode;        // what decides within an action: cas, exch, up, ballot, or, rzi, …
  bool divides = false;    // integers: the divisor is looked at first
  char combine = 0;        // setp with a third operand: & or |
  std::size_t target = 0;  // of a branch
  std::vector<PtxOperand> operands;
  int line = 0;
};

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
};

inline constexpr int kPtxWindowBits = 20;                    // of one shared array's addresses
inline constexpr std::uint64_t kPtxParameters = 1ull << 31;  // where addresses of parameters begin
inline constexpr std::uint64_t kPtxGlobal = 1ull << 32;      // below: not global memory

/// What the interpreter does not know, or does not want: "file:line: what".
struct PtxError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// All kernels of a file's text.
std::vector<PtxKernel> parse_ptx(const std::string& text, const std::string& file);

}  // namespace rptv::cuda_host
