// SPDX-License-Identifier: MIT
// The interpreter's loop, one instruction after the other.
#include "tests/cuda_host/ptx_thread.hpp"

#include <algorithm>
#include <cstring>

#include "tests/cuda_host/collective.hpp"
#include "tests/cuda_host/kernel_language.hpp"
#include "tests/cuda_host/ptx_functions.hpp"
#include "tests/cuda_host/ptx_operands.hpp"

namespace rptv::cuda_host {
namespace {

class Thread {
 public:
  Thread(const PtxKernel& kernel, const unsigned char* parameters, std::uint64_t* registers)
      : kernel_(kernel), parameters_(parameters), registers_(registers) {}

  void run() {
    std::size_t at = 0;
    while (at < kernel_.instructions.size()) {
      const PtxInstruction& now = kernel_.instructions[at++];
      if (now.guard >= 0 && ((register_at(now.guard) & 1u) != 0) == now.guard_negated) continue;
      if (now.action == PtxAction::kExit) return;
      if (now.action == PtxAction::kBranch)
        at = now.target;
      else
        execute(now);
    }
  }

 private:
  void execute(const PtxInstruction& now) {
    switch (now.action) {
      case PtxAction::kCompute:
        return compute(now);
      case PtxAction::kConvert:
        return set(now.operands[0], ptx_convert(value(now.operands[1]), now.from_type, now.type, now.mode));
      case PtxAction::kMove:
        return move(now);
      case PtxAction::kLoad:
        return load(now);
      case PtxAction::kStore:
        return store(now);
      case PtxAction::kAtomic:
        return atomic(now);
      case PtxAction::kBarrier:
        return barrier(now);
      case PtxAction::kWarpBarrier:
        meet(Meeting::kWarp, low(value(now.operands[0])), 0, 0, site(now));
        return;
      case PtxAction::kVote:
        return vote(now);
      case PtxAction::kShuffle:
        return shuffle(now);
      case PtxAction::kFence:
        return fence();
      case PtxAction::kTrap:
        kernel_fault("trap", site(now));
      case PtxAction::kBranch:
      case PtxAction::kExit:
        return;
    }
  }

  void compute(const PtxInstruction& now) {
    const auto& operands = now.operands;
    const std::uint64_t a = value(operands[1]);
    const std::uint64_t b = operands.size() > 2 ? value(operands[2]) : 0;
    std::uint64_t c = operands.size() > 3 ? value(operands[3]) : 0;
    if (operands.size() > 4) c = (c & 0xffffffffu) | value(operands[4]) << 32;
    if (now.divides && kept(b, now.type) == 0) kernel_fault("division by zero", site(now));
    std::uint64_t result = now.compute(a, b, c);
    std::uint64_t other = result ^ 1u;  // of a comparison with two results
    if (now.combine == '&') result &= c, other &= c;
    if (now.combine == '|') result |= c, other |= c;
    if (now.combine == '^') result ^= c, other ^= c;
    if (operands[0].kind != PtxOperandKind::kVector) return set(operands[0], result);
    set(operands[0].elements[0], result);
    set(operands[0].elements[1], other);
  }

  void move(const PtxInstruction& now) {
    const PtxOperand &to = now.operands[0], &from = now.operands[1];
    if (to.kind == PtxOperandKind::kVector) {
      const auto bits = static_cast<unsigned>(now.type.bits / to.elements.size());
      const std::uint64_t whole = value(from);
      for (std::size_t i = 0; i < to.elements.size(); ++i) {
        set(to.elements[i], whole >> (i * bits) & ((std::uint64_t{1} << bits) - 1));
      }
    } else if (from.kind == PtxOperandKind::kVector) {
      const auto bits = static_cast<unsigned>(now.type.bits / from.elements.size());
      std::uint64_t whole = 0;
      for (std::size_t i = 0; i < from.elements.size(); ++i) {
        whole |= (value(from.elements[i]) & ((std::uint64_t{1} << bits) - 1)) << (i * bits);
      }
      set(to, whole);
    } else {
      set(to, kept(value(from), now.type));
    }
  }

  void load(const PtxInstruction& now) {
    for_each_value(now, now.operands[0], now.operands[1], [&](const PtxOperand& to, unsigned char* memory) {
      std::uint64_t bits = 0;
      std::memcpy(&bits, memory, now.type.bytes());
      const bool negative = now.type.kind == 's' && now.type.bits < 64 && (bits >> (now.type.bits - 1) & 1u) != 0;
      set(to, negative ? bits | ~std::uint64_t{0} << now.type.bits : bits);
    });
  }

  void store(const PtxInstruction& now) {
    for_each_value(now, now.operands[1], now.operands[0], [&](const PtxOperand& from, unsigned char* memory) {
      const std::uint64_t bits = value(from);
      std::memcpy(memory, &bits, now.type.bytes());
    });
  }

  template <class Use>
  void for_each_value(const PtxInstruction& now, const PtxOperand& values, const PtxOperand& address, Use use) {
    const bool vector = values.kind == PtxOperandKind::kVector;
    const std::size_t count = vector ? values.elements.size() : 1;
    auto* memory = static_cast<unsigned char*>(
        ptx_memory(kernel_, parameters_, value(address), now.type.bytes(), count, now.line));
    for (std::size_t i = 0; i < count; ++i) use(vector ? values.elements[i] : values, memory + i * now.type.bytes());
  }

  void atomic(const PtxInstruction& now) {
    const bool returns = now.operands[0].kind != PtxOperandKind::kAddress;  // red has no result
    const std::size_t at = returns ? 1 : 0;
    void* memory = ptx_memory(kernel_, parameters_, value(now.operands[at]), now.type.bytes(), 1, now.line);
    std::uint64_t old = 0;
    std::memcpy(&old, memory, now.type.bytes());
    const std::uint64_t b = kept(value(now.operands[at + 1]), now.type);
    std::uint64_t next = b;
    if (now.mode == "cas")
      next = old == b ? value(now.operands[at + 2]) : old;
    else if (now.mode == "inc")
      next = old >= b ? 0 : old + 1;
    else if (now.mode != "exch")
      next = now.compute(old, b, 0);
    std::memcpy(memory, &next, now.type.bytes());
    if (returns) set(now.operands[0], old);
  }

  void barrier(const PtxInstruction& now) {
    const bool reduces = !now.mode.empty();
    if (value(now.operands[reduces ? 1 : 0]) != 0 || now.operands.size() > (reduces ? 3u : 1u)) {
      kernel_fault("only barrier 0 of all threads is interpreted", site(now));
    }
    const std::uint64_t count = meet(Meeting::kBlock, 0, reduces ? value(now.operands[2]) : 0, 0, site(now));
    const std::uint64_t threads = std::uint64_t{blockDim.x} * blockDim.y * blockDim.z;
    if (!reduces) return;
    set(now.operands[0], now.mode == "popc" ? count : now.mode == "or" ? count > 0 : count == threads);
  }

  void vote(const PtxInstruction& now) {
    const std::uint64_t mine = value(now.operands[1]) ^ (now.mode == "all" ? 1u : 0u);
    const std::uint64_t lanes = meet(Meeting::kBallot, low(value(now.operands[2])), mine, 0, site(now));
    set(now.operands[0], now.mode == "ballot" ? lanes : now.mode == "any" ? lanes != 0 : lanes == 0);
  }

  void shuffle(const PtxInstruction& now) {
    const unsigned by = low(value(now.operands[2])) & 31u, control = low(value(now.operands[3]));
    const unsigned segment = control >> 8 & 31u, clamp = control & 31u, here = lane();
    const unsigned last = (here & segment) | (clamp & ~segment);
    unsigned source = (here & segment) | (by & ~segment);  // idx
    if (now.mode == "up") source = here - by;
    if (now.mode == "down") source = here + by;
    if (now.mode == "bfly") source = here ^ by;
    const bool inside = now.mode == "up" ? static_cast<int>(source) >= static_cast<int>(last) : source <= last;
    const std::uint64_t found = meet(Meeting::kExchange, low(value(now.operands[4])), value(now.operands[1]),
                                     inside ? source : here, site(now));
    const PtxOperand& to = now.operands[0];
    const bool pair = to.kind == PtxOperandKind::kVector;
    set(pair ? to.elements[0] : to, found);
    if (pair) set(to.elements[1], inside ? 1 : 0);
  }

  std::uint64_t value(const PtxOperand& operand) const {
    switch (operand.kind) {
      case PtxOperandKind::kRegister:
        return registers_[static_cast<std::size_t>(operand.base)] ^ (operand.negated ? 1u : 0u);
      case PtxOperandKind::kNumber:
        return operand.number;
      case PtxOperandKind::kSpecial:
        return special(operand.base);
      case PtxOperandKind::kAddress:
        return operand.number + (operand.base < 0 ? 0 : address_register(operand.base));
      case PtxOperandKind::kVector:
      case PtxOperandKind::kNowhere:
        break;
    }
    return 0;
  }

  static std::uint64_t special(std::int32_t number) {
    const dim3 thread(threadIdx), block(blockIdx);
    const dim3 of[] = {thread, blockDim, block, gridDim};
    if (number == kPtxLaneId) return lane();
    const dim3& family = of[number / 3];
    return number % 3 == 0 ? family.x : number % 3 == 1 ? family.y : family.z;
  }

  static std::uint64_t kept(std::uint64_t bits, PtxType type) {
    return type.bits == 64 ? bits : bits & ((std::uint64_t{1} << type.bits) - 1);
  }
  static unsigned low(std::uint64_t bits) { return static_cast<unsigned>(bits); }
  Site site(const PtxInstruction& now) const { return {kernel_.file.c_str(), now.line}; }
  std::uint64_t register_at(std::int32_t number) const { return registers_[static_cast<std::size_t>(number)]; }
  std::uint64_t address_register(std::int32_t number) const { return register_at(number); }
  void set(const PtxOperand& to, std::uint64_t bits) {
    if (to.kind == PtxOperandKind::kRegister) registers_[static_cast<std::size_t>(to.base)] = bits;
  }

  const PtxKernel& kernel_;
  const unsigned char* parameters_;
  std::uint64_t* registers_;
};

}  // namespace

void run_ptx_thread(const PtxKernel& kernel, const unsigned char* parameters) {
  // On the stack: nobody would free them where a fault leaves the fiber for good.
  auto* registers = static_cast<std::uint64_t*>(__builtin_alloca(kernel.registers * sizeof(std::uint64_t)));
  std::fill_n(registers, kernel.registers, 0xA5A5A5A5A5A5A5A5u);
  Thread(kernel, parameters, registers).run();
}

}  // namespace rptv::cuda_host
