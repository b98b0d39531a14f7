// SPDX-License-Identifier: MIT
// Asks the CUDA runtime for a device's name, clocks and widths.
#include "reconstruct/cuda_device_limits.hpp"

#include "reconstruct/cuda_require.hpp"

namespace rptv {

CudaDeviceLimits ask_cuda_device_limits() {
  CudaDeviceLimits limits;
  int device = 0;
  cudaDeviceProp properties{};
  require_cuda(cudaGetDevice(&device), "no device");
  require_cuda(cudaGetDeviceProperties(&properties, device), "no properties of the device");
  require_cuda(cudaRuntimeGetVersion(&limits.toolkit), "no version of the runtime");
  require_cuda(cudaDriverGetVersion(&limits.driver), "no version of the driver");
  const auto ask = [device](cudaDeviceAttr attribute) {
    int value = 0;
    require_cuda(cudaDeviceGetAttribute(&value, attribute, device), "an attribute of the device is not known");
    return value;
  };
  limits.name = properties.name;
  limits.multiprocessors = ask(cudaDevAttrMultiProcessorCount);
  limits.memory_bus_bits = ask(cudaDevAttrGlobalMemoryBusWidth);
  limits.clock_hz = 1e3 * ask(cudaDevAttrClockRate);
  limits.memory_clock_hz = 1e3 * ask(cudaDevAttrMemoryClockRate);
  return limits;
}

}  // namespace rptv
