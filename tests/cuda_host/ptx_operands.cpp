// SPDX-License-Identifier: MIT
// Reads the operands of PTX instructions.
#include "tests/cuda_host/ptx_operands.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace rptv::cuda_host {
namespace {

/// The number of a special register, or -1.
std::int32_t special_register(const std::string& name) {
  static const std::map<std::string, std::int32_t> kFamilies{
      {"%tid.", 0}, {"%ntid.", 3}, {"%ctaid.", 6}, {"%nctaid.", 9}};
  if (name == "%laneid") return kPtxLaneId;
  if (name.size() < 6) return -1;
  const auto family = kFamilies.find(name.substr(0, name.size() - 1));
  return family == kFamilies.end() ? -1 : family->second + (name.back() - 'x');
}

/// 12, -1, 0x1F, 0f3F800000 (bits of a float), 0d3FF0000000000000.
bool read_number(const std::string& text, std::uint64_t& bits) {
  const std::size_t digit = text[0] == '-' ? 1 : 0;
  if (text.size() <= digit || std::isdigit(static_cast<unsigned char>(text[digit])) == 0) return false;
  const char form = text.size() > 2 ? static_cast<char>(std::tolower(static_cast<unsigned char>(text[1]))) : ' ';
  if (text[0] == '0' && (form == 'f' || form == 'd')) {
    bits = std::strtoull(text.c_str() + 2, nullptr, 16);
  } else {
    bits = std::strtoull(text.c_str() + digit, nullptr, 0);
    if (digit == 1) bits = 0 - bits;
  }
  return true;
}

PtxOperand vector_of(PtxNames& names, const std::vector<std::string>& elements) {
  PtxOperand vector;
  vector.kind = PtxOperandKind::kVector;
  for (const std::string& element : elements) vector.elements.push_back(names.operand(element));
  return vector;
}

}  // namespace

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::string part;
  int depth = 0;
  const auto take = [&] {
    const auto first = part.find_first_not_of(" \t\n\r");
    if (first != std::string::npos) parts.push_back(part.substr(first, part.find_last_not_of(" \t\n\r") - first + 1));
    part.clear();
  };
  for (const char c : text) {
    if (c == '{' || c == '[') ++depth;
    if (c == '}' || c == ']') --depth;
    if (c == separator && depth == 0)
      take();
    else
      part += c;
  }
  take();
  return parts;
}

void PtxNames::declare(const std::string& text) {
  if (scopes_.empty()) return;  // registers of the kernel itself are known by their use
  for (std::string name : split(text.substr(std::min(text.find('%'), text.size())), ',')) {
    const std::size_t range = name.find('<');
    const std::size_t count = range == std::string::npos ? 0 : std::stoul(name.substr(range + 1));
    name.resize(std::min(range, name.size()));
    for (std::size_t i = 0; i < std::max<std::size_t>(count, 1); ++i) {
      const std::string one = count == 0 ? name : name + std::to_string(i);
      const auto number = static_cast<std::int32_t>(registers.size());
      registers.emplace(one + " of scope " + std::to_string(number), number);
      scopes_.back()[one] = number;
    }
  }
}

std::int32_t PtxNames::register_of(const std::string& name) {
  if (name[0] != '%') throw PtxError("'" + name + "' is not known");
  for (auto scope = scopes_.rbegin(); scope != scopes_.rend(); ++scope)
    if (const auto found = scope->find(name); found != scope->end()) return found->second;
  return registers.emplace(name, static_cast<std::int32_t>(registers.size())).first->second;
}

PtxOperand PtxNames::address(const std::string& text) {
  PtxOperand found;
  found.kind = PtxOperandKind::kAddress;
  for (const std::string& term : split(text, '+')) {
    std::uint64_t number = 0;
    const auto symbol = symbols.find(term);
    if (symbol != symbols.end())
      found.number += symbol->second;
    else if (read_number(term, number))
      found.number += number;
    else
      found.base = register_of(term);
  }
  return found;
}

PtxOperand PtxNames::operand(const std::string& text) {
  PtxOperand found;
  if (text == "_") return found;
  if (text[0] == '[') return address(text.substr(1, text.size() - 2));
  if (text[0] == '{') return vector_of(*this, split(text.substr(1, text.size() - 2), ','));
  if (text.find('|') != std::string::npos) return vector_of(*this, split(text, '|'));
  if (text[0] == '!') {
    found = operand(split(text.substr(1), ' ')[0]);
    found.negated = true;
    return found;
  }
  const auto symbol = symbols.find(text);
  if (symbol != symbols.end() || read_number(text, found.number)) {
    found.kind = PtxOperandKind::kNumber;
    if (symbol != symbols.end()) found.number = symbol->second;
    return found;
  }
  found.base = special_register(text);
  found.kind = found.base >= 0 ? PtxOperandKind::kSpecial : PtxOperandKind::kRegister;
  if (found.base < 0) found.base = register_of(text);
  return found;
}

}  // namespace rptv::cuda_host
