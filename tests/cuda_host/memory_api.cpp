// SPDX-License-Identifier: MIT
// Allocation of device memory and page-locked host memory.
#include "tests/cuda_host/memory_api.hpp"

#include <cstdlib>
#include <cstring>

#include "tests/cuda_host/runtime.hpp"
#include "tests/cuda_host/sanitizer_hooks.hpp"

using namespace rptv::cuda_host;

namespace {

constexpr std::size_t kDeviceBytes = std::size_t{4} << 30;

cudaError_t not_from(Runtime& device, const char* free_call, const char* allocating_call) {
  return device.blame(cudaErrorInvalidValue, std::string(free_call) + ": the pointer is not from " + allocating_call +
                                                 ", or was freed before");
}

}  // namespace

cudaError_t cudaMalloc(void** pointer, std::size_t bytes) {
  return call([&](Runtime& device) {
    *pointer = nullptr;
    if (bytes == 0) return cudaSuccess;
    if (device.memory.bytes_in_use() + bytes > kDeviceBytes) return cudaErrorMemoryAllocation;
    *pointer = device.memory.allocate(bytes);
    return *pointer == nullptr ? cudaErrorMemoryAllocation : cudaSuccess;
  });
}

cudaError_t cudaFree(void* pointer) {
  const cudaError_t error = call([&](Runtime& device) { return device.run_all(); });
  Runtime& device = runtime();
  const std::lock_guard<std::mutex> turn(device.mutex);  // freed after a failed launch, too
  if (pointer == nullptr || device.memory.release(pointer)) return error;
  return device.last_error = not_from(device, "cudaFree", "cudaMalloc");
}

cudaError_t cudaMallocHost(void** pointer, std::size_t bytes, unsigned) {
  return call([&](Runtime& device) {
    const Unobserved unobserved;
    *pointer = nullptr;
    if (bytes == 0) return cudaSuccess;
    if (posix_memalign(pointer, 4096, bytes) != 0) return cudaErrorMemoryAllocation;
    std::memset(*pointer, 0xA5, bytes);
    device.pinned.add(*pointer, bytes, true);
    return cudaSuccess;
  });
}

cudaError_t cudaHostAlloc(void** pointer, std::size_t bytes, unsigned flags) {
  return cudaMallocHost(pointer, bytes, flags);
}

cudaError_t cudaFreeHost(void* pointer) {
  const cudaError_t error = call([&](Runtime& device) { return device.run_all(); });
  Runtime& device = runtime();
  const std::lock_guard<std::mutex> turn(device.mutex);
  if (pointer == nullptr) return error;
  if (!device.pinned.remove(pointer, true))
    return device.last_error = not_from(device, "cudaFreeHost", "cudaMallocHost");
  std::free(pointer);
  return error;
}

cudaError_t cudaHostRegister(void* pointer, std::size_t bytes, unsigned) {
  return call([&](Runtime& device) {
    if (pointer == nullptr || bytes == 0) return cudaErrorInvalidValue;
    return device.pinned.add(pointer, bytes, false) ? cudaSuccess : cudaErrorHostMemoryAlreadyRegistered;
  });
}

cudaError_t cudaHostUnregister(void* pointer) {
  return call([&](Runtime& device) {
    const std::size_t bytes = device.pinned.size_at(pointer);
    if (bytes > 0 && device.device_queues.uses(pointer, bytes)) {
      return device.blame(cudaErrorInvalidValue, "cudaHostUnregister: a copy from or to the range has not run yet");
    }
    return device.pinned.remove(pointer, false) ? cudaSuccess : cudaErrorHostMemoryNotRegistered;
  });
}

cudaError_t cudaMemGetInfo(std::size_t* free_bytes, std::size_t* total_bytes) {
  return call([&](Runtime& device) {
    *total_bytes = kDeviceBytes;
    *free_bytes = kDeviceBytes - device.memory.bytes_in_use();
    return cudaSuccess;
  });
}
