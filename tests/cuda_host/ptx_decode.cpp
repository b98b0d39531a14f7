// SPDX-License-Identifier: MIT
// From the parts of a PTX opcode to what the interpreter does; what it does not know, or must not take, is an error.
#include <algorithm>
#include <cctype>

#include "tests/cuda_host/ptx_functions.hpp"

namespace rptv::cuda_host {
namespace {

using Parts = std::vector<std::string>;

bool is_type(const std::string& part) {
  if (part == "pred") return true;
  return part.size() > 1 && std::string("usbf").find(part[0]) != std::string::npos &&
         std::all_of(part.begin() + 1, part.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

PtxType type_of(const std::string& part) {
  if (part == "pred") return {'p', 1};
  return {part[0], static_cast<std::uint8_t>(std::stoi(part.substr(1)))};
}

bool has(const Parts& parts, const char* name) { return std::find(parts.begin(), parts.end(), name) != parts.end(); }

std::string joined(const Parts& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ".") + part;
  return text;
}

void decode_memory(const Parts& parts, PtxInstruction& instruction) {
  const std::string& root = parts[0];
  instruction.action = root == "ld" ? PtxAction::kLoad : root == "st" ? PtxAction::kStore : PtxAction::kAtomic;
  for (const char* other : {"local", "const", "tex"}) {
    if (has(parts, other))
      throw PtxError("memory of kind ." + std::string(other) + " is not interpreted; keep kernels free of it");
  }
  if (has(parts, "global")) instruction.space = PtxSpace::kGlobal;
  if (has(parts, "shared") || has(parts, "shared::cta")) instruction.space = PtxSpace::kShared;
  if (has(parts, "param")) instruction.space = PtxSpace::kParameter;
  if (instruction.action != PtxAction::kAtomic) return;
  if (instruction.type.kind == 'f') throw PtxError("an atomic sum of floats: its order is free; count in integers");
  for (const char* name : {"add", "min", "max", "and", "or", "xor", "exch", "cas", "inc"}) {
    if (has(parts, name)) instruction.mode = name;
  }
  instruction.compute = ptx_integer_function(instruction.mode, instruction.type);
  if (instruction.mode.empty()) throw PtxError("no such atomic operation here");
}

void decode_conversion(const Parts& modifiers, const std::vector<PtxType>& types, PtxInstruction& instruction) {
  if (types.size() != 2 || modifiers.size() > 2) throw PtxError("a conversion that is not interpreted");
  instruction.action = PtxAction::kConvert;
  instruction.type = types[0];
  instruction.from_type = types[1];
  if (modifiers.size() == 2) instruction.mode = modifiers[1];
  for (const char* known : {"", "rn", "rni", "rzi", "rmi", "rpi"}) {
    if (instruction.mode == known) return;
  }
  throw PtxError("rounding ." + instruction.mode + " is not interpreted");
}

void decode_comparison(const Parts& modifiers, PtxInstruction& instruction) {
  instruction.action = PtxAction::kCompute;
  if (modifiers.size() > 3 || modifiers.size() < 2) throw PtxError("a comparison that is not interpreted");
  instruction.compute = ptx_comparison(modifiers[1], instruction.type);
  if (modifiers.size() < 3) return;
  instruction.combine = modifiers[2] == "and" ? '&' : modifiers[2] == "or" ? '|' : modifiers[2] == "xor" ? '^' : '?';
  if (instruction.combine == '?') throw PtxError("." + modifiers[2] + " after a comparison is not interpreted");
}

void decode_arithmetic(const Parts& modifiers, PtxInstruction& instruction) {
  instruction.action = PtxAction::kCompute;
  const std::string operation = joined(modifiers);
  const bool is_float = instruction.type.kind == 'f';
  if (is_float && (operation == "add" || operation == "sub" || operation == "mul")) {
    throw PtxError("'" + operation + "' without .rn may be fused; compile with --fmad=false");
  }
  instruction.compute =
      is_float ? ptx_float_function(operation, instruction.type) : ptx_integer_function(operation, instruction.type);
  if (instruction.compute == nullptr && !is_float)
    instruction.compute = ptx_bit_field_function(operation, instruction.type);
  instruction.divides = !is_float && (operation == "div" || operation == "rem");
}

bool decode_control(const Parts& parts, PtxInstruction& instruction) {
  const std::string& root = parts[0];
  if (root == "bra")
    instruction.action = PtxAction::kBranch;
  else if (root == "ret" || root == "exit")
    instruction.action = PtxAction::kExit;
  else if (root == "trap")
    instruction.action = PtxAction::kTrap;
  else if (root == "membar" || root == "fence")
    instruction.action = PtxAction::kFence;
  else if (root == "bar" && has(parts, "warp"))
    instruction.action = PtxAction::kWarpBarrier;
  else if (root == "bar" || root == "barrier")
    instruction.action = PtxAction::kBarrier;
  else if (root == "vote")
    instruction.action = PtxAction::kVote;
  else if (root == "shfl")
    instruction.action = PtxAction::kShuffle;
  else
    return false;
  for (const char* mode : {"popc", "and", "or", "any", "all", "ballot", "up", "down", "bfly", "idx"}) {
    if (has(parts, mode)) instruction.mode = mode;
  }
  if (has(parts, "arrive") || has(parts, "uni")) {
    if (root != "bra") throw PtxError("'" + joined(parts) + "' is not interpreted");
  }
  return true;
}

}  // namespace

void decode_ptx(const Parts& parts, PtxInstruction& instruction) {
  if (parts[0] == "call") throw PtxError("a call is not interpreted; let kernels inline their functions");
  Parts modifiers;  // the root among them
  std::vector<PtxType> types;
  for (const std::string& part : parts) {
    if (is_type(part))
      types.push_back(type_of(part));
    else
      modifiers.push_back(part);
  }
  if (decode_control(parts, instruction)) return;
  if (types.empty()) throw PtxError("'" + joined(parts) + "' is not interpreted");
  instruction.type = types.back();
  const std::string& root = parts[0];
  if (root == "ld" || root == "st" || root == "atom" || root == "red") {
    decode_memory(parts, instruction);
  } else if (root == "mov" || root == "cvta") {
    instruction.action = PtxAction::kMove;
  } else if (root == "cvt") {
    decode_conversion(modifiers, types, instruction);
  } else {
    if (root == "setp")
      decode_comparison(modifiers, instruction);
    else
      decode_arithmetic(modifiers, instruction);
    if (instruction.compute == nullptr) throw PtxError("'" + joined(parts) + "' is not interpreted");
  }
}

}  // namespace rptv::cuda_host
