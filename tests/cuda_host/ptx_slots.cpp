// SPDX-License-Identifier: MIT
// Makes what most instructions are, one value computed from registers, quick to run.
#include <map>

#include "tests/cuda_host/ptx_program.hpp"

namespace rptv::cuda_host {
namespace {

using Bits = std::uint64_t;

/// What a move keeps of its value.
PtxCompute keeping(PtxType type) {
  switch (type.bits) {
    case 1:
      return [](Bits a, Bits, Bits) -> Bits { return a & 1u; };
    case 16:
      return [](Bits a, Bits, Bits) -> Bits { return a & 0xffffu; };
    case 32:
      return [](Bits a, Bits, Bits) -> Bits { return a & 0xffffffffu; };
    default:
      return [](Bits a, Bits, Bits) -> Bits { return a; };
  }
}

bool is_plain(const PtxInstruction& instruction) {
  const bool computes = instruction.action == PtxAction::kCompute && !instruction.divides && instruction.combine == 0;
  if (!computes && instruction.action != PtxAction::kMove) return false;
  if (instruction.operands.size() > 4) return false;
  for (const PtxOperand& operand : instruction.operands) {
    if (operand.kind != PtxOperandKind::kRegister || operand.negated) return false;
  }
  return true;
}

}  // namespace

void assign_slots(PtxKernel& kernel) {
  std::map<Bits, std::size_t> places;
  for (PtxInstruction& instruction : kernel.instructions) {
    for (PtxOperand& operand : instruction.operands) {
      if (operand.kind != PtxOperandKind::kNumber) continue;
      const auto [place, is_new] = places.emplace(operand.number, places.size());
      if (is_new) kernel.constants.push_back(operand.number);
      operand.kind = PtxOperandKind::kRegister;
      operand.base = static_cast<std::int32_t>(kernel.registers + place->second);
    }
    instruction.plain = is_plain(instruction);
    if (!instruction.plain) continue;
    if (instruction.action == PtxAction::kMove) instruction.compute = keeping(instruction.type);
    for (std::size_t i = 0; i < instruction.operands.size(); ++i) {
      instruction.slots[i] = static_cast<std::uint32_t>(instruction.operands[i].base);
    }
  }
}

}  // namespace rptv::cuda_host
