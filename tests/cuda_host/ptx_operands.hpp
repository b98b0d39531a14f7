// SPDX-License-Identifier: MIT
// Operands of PTX: registers, numbers, special registers, addresses, and vectors of them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tests/cuda_host/ptx_program.hpp"

namespace rptv::cuda_host {

/// Special registers by number: %tid.x, y, z, then %ntid, %ctaid, %nctaid, and %laneid.
inline constexpr std::int32_t kPtxLaneId = 12;

struct PtxNames {
  std::map<std::string, std::int32_t> registers;
  std::map<std::string, std::uint64_t> symbols;  // shared arrays and parameters

  std::int32_t register_of(const std::string& name);
  PtxOperand operand(const std::string& text);

  /// Inner braces: what is declared there (".reg .pred %p1, %q<4>") hides what has the same name outside.
  void open_scope() { scopes_.emplace_back(); }
  void close_scope() { scopes_.pop_back(); }
  void declare(const std::string& text);

 private:
  PtxOperand address(const std::string& text);

  std::vector<std::map<std::string, std::int32_t>> scopes_;
};

/// Splits where the separator stands outside of brackets and braces; parts are trimmed, an empty text has none.
std::vector<std::string> split(const std::string& text, char separator);

}  // namespace rptv::cuda_host
