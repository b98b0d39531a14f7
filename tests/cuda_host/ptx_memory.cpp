// SPDX-License-Identifier: MIT
// Checks every address that a PTX kernel uses, before it is used.
#include <string>

#include "tests/cuda_host/ptx_thread.hpp"
#include "tests/cuda_host/runtime.hpp"

namespace rptv::cuda_host {
namespace {

[[noreturn]] void refuse(const PtxKernel& kernel, int line, const std::string& what) {
  static std::string text;  // one launch runs at a time
  text = what;
  kernel_fault(text.c_str(), {kernel.file.c_str(), line});
}

}  // namespace

void* ptx_memory(const PtxKernel& kernel, const unsigned char* parameters, std::uint64_t address,
                 std::size_t value_bytes, std::size_t count, int line) {
  const std::size_t bytes = value_bytes * count;
  if (address % bytes != 0)
    refuse(kernel, line, "address " + std::to_string(address) + " is no multiple of " + std::to_string(bytes));
  if (address >= kPtxGlobal) {
    void* const pointer = reinterpret_cast<void*>(address);
    const Runtime& device = runtime();
    if (device.memory.holds(pointer, bytes) || device.pinned.hold(pointer, bytes)) return pointer;
    char place[96] = "no block is near";
    device.memory.describe(pointer, place, sizeof place);
    refuse(kernel, line, std::to_string(bytes) + " bytes outside of device memory: " + place);
  }
  if (address >= kPtxParameters) {
    const std::uint64_t offset = address - kPtxParameters;
    if (offset + bytes > kernel.parameter_bytes) refuse(kernel, line, "past the end of the parameters");
    return const_cast<unsigned char*>(parameters) + offset;
  }
  const std::uint64_t window = address >> kPtxWindowBits;
  const std::uint64_t offset = address & ((1u << kPtxWindowBits) - 1);
  if (window == 0 || window > kernel.shared.size())
    refuse(kernel, line, "address " + std::to_string(address) + " is no memory");
  const PtxShared& array = kernel.shared[window - 1];
  const bool dynamic = array.size_bytes == 0;
  const std::size_t size_bytes = dynamic ? running.block->storage().dynamic_bytes() : array.size_bytes;
  if (offset + bytes > size_bytes) {
    refuse(kernel, line,
           "offset " + std::to_string(offset) + " of '" + array.name + "', which has " + std::to_string(size_bytes) +
               " bytes");
  }
  void* const begin = dynamic ? dynamic_shared()
                              : shared_array(&array, size_bytes, array.alignment_bytes, array.name.c_str(),
                                             {kernel.file.c_str(), line});
  return static_cast<unsigned char*>(begin) + offset;
}

}  // namespace rptv::cuda_host
