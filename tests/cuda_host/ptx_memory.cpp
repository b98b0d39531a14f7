// SPDX-License-Identifier: MIT
// Checks every address that a PTX kernel uses, before it is used.
#include <cstdarg>
#include <cstdint>
#include <cstdio>

#include "tests/cuda_host/ptx_thread.hpp"
#include "tests/cuda_host/runtime.hpp"

namespace rptv::cuda_host {
namespace {

/// Formats into memory of its own: a fiber that is left for good frees nothing.
[[noreturn, gnu::format(printf, 3, 4)]] void refuse(const PtxKernel& kernel, int line, const char* format, ...) {
  static char text[512];  // one launch runs at a time
  va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof text, format, values);
  va_end(values);
  kernel_fault(text, {kernel.file.c_str(), line});
}

}  // namespace

void* ptx_memory(const PtxKernel& kernel, const unsigned char* parameters, std::uint64_t address,
                 std::size_t value_bytes, std::size_t count, int line) {
  const std::size_t bytes = value_bytes * count;
  if (address % bytes != 0) refuse(kernel, line, "address 0x%jx is no multiple of %zu", std::uintmax_t{address}, bytes);
  if (address >= kPtxGlobal) {
    void* const pointer = reinterpret_cast<void*>(address);
    const Runtime& device = runtime();
    if (device.memory.holds(pointer, bytes) || device.pinned.hold(pointer, bytes)) return pointer;
    char place[96] = "no block is near";
    device.memory.describe(pointer, place, sizeof place);
    refuse(kernel, line, "%zu bytes outside of device memory: %s", bytes, place);
  }
  if (address >= kPtxParameters) {
    const std::uint64_t offset = address - kPtxParameters;
    if (offset + bytes > kernel.parameter_bytes) refuse(kernel, line, "past the end of the parameters");
    return const_cast<unsigned char*>(parameters) + offset;
  }
  const std::uint64_t window = address >> kPtxWindowBits;
  const std::uint64_t offset = address & ((1u << kPtxWindowBits) - 1);
  if (window == 0 || window > kernel.shared.size())
    refuse(kernel, line, "address 0x%jx is no memory", std::uintmax_t{address});
  const PtxShared& array = kernel.shared[window - 1];
  const bool dynamic = array.size_bytes == 0;
  const std::size_t size_bytes = dynamic ? running.block->storage().dynamic_bytes() : array.size_bytes;
  if (offset + bytes > size_bytes) {
    refuse(kernel, line, "offset %ju of '%s', which has %zu bytes", std::uintmax_t{offset}, array.name.c_str(),
           size_bytes);
  }
  if (dynamic) return static_cast<unsigned char*>(dynamic_shared()) + offset;
  const Site site{kernel.file.c_str(), line};
  return static_cast<unsigned char*>(
             shared_array(&array, size_bytes, array.alignment_bytes, array.name.c_str(), site)) +
         offset;
}

}  // namespace rptv::cuda_host
