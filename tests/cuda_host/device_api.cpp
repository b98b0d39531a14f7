// SPDX-License-Identifier: MIT
// Answers about the device that the stand-in is, and the machines that tests make of it.
#include "tests/cuda_host/device_api.hpp"

#include <cstdio>

#include "tests/cuda_host/device_limits.hpp"
#include "tests/cuda_host/runtime.hpp"

using rptv::cuda_host::call;
using rptv::cuda_host::Runtime;
using namespace rptv::cuda_host;

namespace {

cudaError_t usable(const Runtime& machine) {
  if (machine.driver_version < CUDART_VERSION) return cudaErrorInsufficientDriver;
  return machine.devices == 0 ? cudaErrorNoDevice : cudaSuccess;
}

cudaError_t usable(const Runtime& machine, int device) {
  if (const cudaError_t error = usable(machine)) return error;
  return device >= 0 && device < machine.devices ? cudaSuccess : cudaErrorInvalidDevice;
}

}  // namespace

cudaError_t cudaGetDeviceCount(int* count) {
  return call([&](Runtime& machine) {
    *count = usable(machine) == cudaSuccess ? machine.devices : 0;
    return usable(machine);
  });
}

cudaError_t cudaSetDevice(int device) {
  return call([&](Runtime& machine) { return usable(machine, device); });
}

cudaError_t cudaGetDevice(int* device) {
  *device = 0;
  return call([&](Runtime& machine) { return usable(machine); });
}

cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int device) {
  return call([&](Runtime& machine) {
    if (const cudaError_t error = usable(machine, device)) return error;
    *properties = {};
    std::snprintf(properties->name, sizeof properties->name, "CUDA on the host");
    properties->totalGlobalMem = std::size_t{4} << 30;
    properties->sharedMemPerBlock = kSharedBytes;
    properties->sharedMemPerBlockOptin = kSharedOptInBytes;
    properties->sharedMemPerMultiprocessor = kSharedOptInBytes;
    properties->warpSize = 32;
    properties->maxThreadsPerBlock = kMaxThreads;
    const int threads[] = {kMaxThreads, kMaxThreads, kMaxBlockZ};
    const int blocks[] = {kMaxGridX, kMaxGridYz, kMaxGridYz};
    for (int axis = 0; axis < 3; ++axis) {
      properties->maxThreadsDim[axis] = threads[axis];
      properties->maxGridSize[axis] = blocks[axis];
    }
    properties->major = 7;
    properties->minor = 5;
    properties->multiProcessorCount = kMultiprocessors;
    properties->asyncEngineCount = 2;
    properties->concurrentKernels = 1;
    return cudaSuccess;
  });
}

cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int device) {
  return call([&](Runtime& machine) {
    if (const cudaError_t error = usable(machine, device)) return error;
    switch (attribute) {
      case cudaDevAttrMaxThreadsPerBlock:
        *value = kMaxThreads;
        return cudaSuccess;
      case cudaDevAttrMaxSharedMemoryPerBlock:
        *value = kSharedBytes;
        return cudaSuccess;
      case cudaDevAttrWarpSize:
        *value = 32;
        return cudaSuccess;
      case cudaDevAttrClockRate:
        *value = kClockKhz;
        return cudaSuccess;
      case cudaDevAttrMemoryClockRate:
        *value = kMemoryClockKhz;
        return cudaSuccess;
      case cudaDevAttrGlobalMemoryBusWidth:
        *value = kMemoryBusBits;
        return cudaSuccess;
      case cudaDevAttrMultiProcessorCount:
        *value = kMultiprocessors;
        return cudaSuccess;
      case cudaDevAttrComputeCapabilityMajor:
        *value = 7;
        return cudaSuccess;
      case cudaDevAttrComputeCapabilityMinor:
        *value = 5;
        return cudaSuccess;
      case cudaDevAttrMaxSharedMemoryPerBlockOptin:
        *value = kSharedOptInBytes;
        return cudaSuccess;
      case cudaDevAttrHostRegisterSupported:
        *value = 1;
        return cudaSuccess;
    }
    return cudaErrorInvalidValue;
  });
}

cudaError_t cudaRuntimeGetVersion(int* version) {
  *version = CUDART_VERSION;
  return cudaSuccess;
}

cudaError_t cudaDriverGetVersion(int* version) {
  const std::lock_guard<std::mutex> turn(runtime().mutex);
  *version = runtime().driver_version;
  return cudaSuccess;
}

cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* attributes, const void* kernel) {
  return call([&](Runtime& machine) {
    if (const cudaError_t error = usable(machine)) return error;
    const auto raised = machine.dynamic_limit_bytes.find(kernel);
    const std::size_t limit_bytes = raised == machine.dynamic_limit_bytes.end() ? kSharedBytes : raised->second;
    *attributes = {};
    attributes->maxThreadsPerBlock = kMaxThreads;
    attributes->maxDynamicSharedSizeBytes = static_cast<int>(limit_bytes);
    attributes->ptxVersion = attributes->binaryVersion = 75;
    return cudaSuccess;
  });
}

cudaError_t cudaFuncSetAttribute(const void* kernel, cudaFuncAttribute attribute, int value) {
  return call([&](Runtime& machine) {
    if (attribute != cudaFuncAttributeMaxDynamicSharedMemorySize) return cudaSuccess;
    if (value < 0 || static_cast<std::size_t>(value) > kSharedOptInBytes) {
      return machine.blame(cudaErrorInvalidValue,
                           "cudaFuncSetAttribute: " + std::to_string(value) +
                               " bytes of dynamic shared memory; every device has 65536 at most");
    }
    machine.dynamic_limit_bytes[kernel] = static_cast<std::size_t>(value);
    return cudaSuccess;
  });
}
