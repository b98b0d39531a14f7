// SPDX-License-Identifier: MIT
// Reads the text of a PTX file: entries, their parameters, shared arrays, labels and instructions.
#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <sstream>

#include "tests/cuda_host/ptx_functions.hpp"
#include "tests/cuda_host/ptx_operands.hpp"
#include "tests/cuda_host/ptx_program.hpp"

namespace rptv::cuda_host {
namespace {

constexpr std::size_t kPtxMaxRegisters = 16384;  // they lie on a fiber's stack

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\n\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\n\r") - first + 1);
}

/// Comments become blanks; lines stay where they are.
std::string without_comments(std::string text) {
  for (std::size_t i = 0; i + 1 < text.size(); ++i) {
    if (text[i] != '/') continue;
    if (text[i + 1] == '/') {
      while (i < text.size() && text[i] != '\n') text[i++] = ' ';
    } else if (text[i + 1] == '*') {
      const std::size_t end = std::min(text.find("*/", i), text.size() - 2) + 2;
      for (; i < end; ++i) text[i] = text[i] == '\n' ? '\n' : ' ';
    }
  }
  return text;
}

/// `.align A` and the size in bytes of `.u64 name` or `.b8 name[128]`; the alignment after .ptr is the pointee's.
struct Declaration {
  std::string name;
  std::size_t size_bytes, alignment_bytes;
};

Declaration declaration(const std::string& text) {
  static const std::regex kForm(
      R"((?:\.align\s+(\d+)\s+)?\.[usbf](\d+)\s+(?:\.ptr(?:\s+\.\w+)*?(?:\s+\.align\s+\d+)?\s+)?([\w$%]+)\s*(\[\s*(\d*)\s*\])?\s*$)");
  std::smatch found;
  if (!std::regex_search(text, found, kForm))
    throw PtxError("'" + trimmed(text) + "' is no declaration that is interpreted");
  const std::size_t element_bytes = std::stoul(found[2]) / 8;
  const std::size_t count = !found[4].matched ? 1 : found[5].length() == 0 ? 0 : std::stoul(found[5]);
  return {found[3], element_bytes * count, found[1].matched ? std::stoul(found[1]) : element_bytes};
}

class Body {
 public:
  Body(PtxKernel& kernel, const std::vector<Declaration>& shared_of_file) : kernel_(kernel) {
    for (const Declaration& array : shared_of_file) add_shared(array);
    for (const PtxParameter& parameter : kernel.parameters)
      names_.symbols[parameter.name] = kPtxParameters + parameter.offset_bytes;
  }

  void statement(const std::string& text, int line) {
    if (text.empty() || text.rfind(".loc", 0) == 0 || text.rfind(".pragma", 0) == 0) return;
    if (text.rfind(".reg", 0) == 0) return names_.declare(text);
    if (text.rfind(".shared", 0) == 0) return add_shared(declaration(text));
    if (text[0] == '.') throw PtxError("'" + text + "' is not interpreted");
    PtxInstruction instruction;
    instruction.line = line;
    std::istringstream words(text);
    std::string opcode;
    words >> opcode;
    if (opcode[0] == '@') {
      const bool negated = opcode[1] == '!';
      instruction.guard_negated = negated;
      instruction.guard = names_.register_of(opcode.substr(negated ? 2 : 1));
      words >> opcode;
    }
    std::string rest;
    std::getline(words, rest, '\0');
    decode_ptx(split(opcode, '.'), instruction);
    if (instruction.action == PtxAction::kBranch) {
      branches_.emplace_back(kernel_.instructions.size(), trimmed(rest));
    } else {
      for (const std::string& operand : split(rest, ',')) instruction.operands.push_back(names_.operand(operand));
    }
    kernel_.instructions.push_back(std::move(instruction));
  }

  void open_scope() { names_.open_scope(); }
  void close_scope() { names_.close_scope(); }
  void label(const std::string& name) { labels_[name] = kernel_.instructions.size(); }

  void finish() {
    for (const auto& [at, name] : branches_) {
      const auto found = labels_.find(name);
      if (found == labels_.end()) throw PtxError("no label '" + name + "'");
      kernel_.instructions[at].target = found->second;
    }
    kernel_.registers = names_.registers.size();
    assign_slots(kernel_);
    if (kernel_.registers + kernel_.constants.size() > kPtxMaxRegisters)
      throw PtxError("more than " + std::to_string(kPtxMaxRegisters) + " registers and constants");
  }

 private:
  void add_shared(const Declaration& array) {
    const std::uint64_t window = (kernel_.shared.size() + 1) << kPtxWindowBits;
    kernel_.shared.push_back({array.name, array.size_bytes, array.alignment_bytes, window});
    names_.symbols[array.name] = window;
  }

  PtxKernel& kernel_;
  PtxNames names_;
  std::map<std::string, std::size_t> labels_;
  std::vector<std::pair<std::size_t, std::string>> branches_;
};

void parse_parameters(const std::string& text, PtxKernel& kernel) {
  for (const std::string& parameter : split(text, ',')) {
    if (trimmed(parameter).empty()) continue;
    const Declaration found = declaration(parameter);
    const std::size_t offset =
        (kernel.parameter_bytes + found.alignment_bytes - 1) / found.alignment_bytes * found.alignment_bytes;
    kernel.parameters.push_back({found.name, offset, found.size_bytes});
    kernel.parameter_bytes = offset + found.size_bytes;
  }
}

/// From after the opening brace to the one that closes it; returns where.
std::size_t parse_body(const std::string& text, std::size_t at, Body& body, const std::string& file) {
  std::string pending;
  int depth = 1,
      line = 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  try {
    for (; at < text.size(); ++at) {
      const char c = text[at];
      if (c == '\n') ++line;
      const bool scope = trimmed(pending).empty();
      if (c == ';') {
        body.statement(trimmed(pending), line);
        pending.clear();
      } else if (c == ':' && text[at + 1] != ':' && pending.find('.') == std::string::npos && !scope) {
        body.label(trimmed(pending));
        pending.clear();
      } else if (c == '{' && scope) {
        ++depth;
        body.open_scope();
      } else if (c == '}' && scope) {
        if (--depth == 0) break;
        body.close_scope();
      } else {
        pending += c;
      }
    }
    body.finish();
  } catch (const PtxError& error) {
    throw PtxError(file + ':' + std::to_string(line) + ": " + error.what());
  }
  return at;
}

}  // namespace

std::vector<PtxKernel> parse_ptx(const std::string& original, const std::string& file) {
  const std::string text = without_comments(original);
  static const std::regex kEntry(R"(\.entry\s+([\w$]+)\s*\(([^)]*)\)[^{;]*\{)");
  static const std::regex kShared(R"(\.shared\s+[^;{]*;)");
  std::vector<PtxKernel> kernels;
  std::vector<Declaration> shared;
  auto next = text.cbegin();
  std::smatch entry;
  while (std::regex_search(next, text.cend(), entry, kEntry)) {
    for (std::sregex_iterator array(next, entry[0].first, kShared), end; array != end; ++array) {
      const std::string found = array->str();
      shared.push_back(declaration(found.substr(0, found.size() - 1)));
    }
    PtxKernel kernel;
    kernel.name = entry[1];
    kernel.file = file;
    parse_parameters(entry[2], kernel);
    Body body(kernel, shared);
    const auto begin = static_cast<std::size_t>(entry[0].second - text.cbegin());
    next = text.cbegin() + static_cast<std::ptrdiff_t>(parse_body(text, begin, body, file));
    kernels.push_back(std::move(kernel));
  }
  return kernels;
}

}  // namespace rptv::cuda_host
