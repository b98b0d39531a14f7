// SPDX-License-Identifier: MIT
// One instruction of PTX and its operands, decoded.
#pragma once

#include <cstddef>
#include <cstdint>
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
  bool plain = false;       // one value of registers only: `slots` are result and operands
  std::int32_t guard = -1;  // predicate register; -1: always
  bool guard_negated = false;
  PtxCompute compute = nullptr;
  std::uint32_t slots[4] = {};
  PtxType type, from_type;
  PtxSpace space{};
  std::string mode;        // what decides within an action: cas, exch, up, ballot, or, rzi, …
  bool divides = false;    // integers: the divisor is looked at first
  char combine = 0;        // setp with a third operand: & or |
  std::size_t target = 0;  // of a branch
  std::vector<PtxOperand> operands;
  int line = 0;
};

}  // namespace rptv::cuda_host
