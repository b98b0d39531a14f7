// SPDX-License-Identifier: MIT
// Reads the PTX files once, and packs arguments as a kernel's parameters lie.
#include "tests/cuda_host/ptx_kernels.hpp"

#include <cctype>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/cuda_host/ptx_operands.hpp"
#include "tests/cuda_host/ptx_thread.hpp"

namespace rptv::cuda_host {
namespace {

const char* ptx_files() { return std::getenv("RPTV_CUDA_PTX"); }

std::string text_of(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw PtxError("RPTV_CUDA_PTX names '" + file + "', which cannot be read");
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

const std::map<std::string, PtxKernel>& kernels() {
  static const std::map<std::string, PtxKernel> all = [] {
    std::map<std::string, PtxKernel> found;
    for (const std::string& file : split(ptx_files(), ':')) {
      for (PtxKernel& kernel : parse_ptx(text_of(file), file))
        found.emplace(common_name(kernel.name), std::move(kernel));
    }
    return found;
  }();
  return all;
}

}  // namespace

bool runs_ptx() { return ptx_files() != nullptr; }

std::string common_name(const std::string& mangled) {
  std::string name;
  for (std::size_t at = 0; at < mangled.size();) {
    std::size_t digits = 0;
    while (at + digits < mangled.size() && std::isdigit(static_cast<unsigned char>(mangled[at + digits])) != 0)
      ++digits;
    const std::size_t length = digits == 0 ? 0 : std::strtoul(mangled.substr(at, digits).c_str(), nullptr, 10);
    if (digits > 0 && mangled.compare(at + digits, 11, "_GLOBAL__N_") == 0) {
      name += "12_GLOBAL__N_1";
      at += digits + length;
    } else {
      const std::size_t step = digits == 0 ? 1 : digits;
      name += mangled.substr(at, step);
      at += step;
    }
  }
  return name;
}

std::function<void()> ptx_body(const void* kernel, const ArgumentView* arguments, std::size_t count) {
  const std::string name = symbol_at(kernel);
  const auto found = kernels().find(common_name(name));
  if (found == kernels().end())
    throw PtxError("no PTX of the kernel '" + name + "' in the files that RPTV_CUDA_PTX names");
  const PtxKernel& ptx = found->second;
  if (ptx.parameters.size() != count) throw PtxError("the PTX of '" + name + "' has another number of parameters");
  auto bytes = std::make_shared<std::vector<unsigned char>>(ptx.parameter_bytes);
  for (std::size_t i = 0; i < count; ++i) {
    if (ptx.parameters[i].size_bytes != arguments[i].size_bytes) {
      throw PtxError("parameter " + std::to_string(i) + " of '" + name + "' has " +
                     std::to_string(ptx.parameters[i].size_bytes) + " bytes in PTX and " +
                     std::to_string(arguments[i].size_bytes) + " in C++");
    }
    std::memcpy(bytes->data() + ptx.parameters[i].offset_bytes, arguments[i].value, arguments[i].size_bytes);
  }
  return [&ptx, bytes] { run_ptx_thread(ptx, bytes->data()); };
}

}  // namespace rptv::cuda_host
