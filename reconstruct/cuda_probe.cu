// SPDX-License-Identifier: MIT
// The probe in a build with CUDA: driver, devices, and code for one of them.
#include "reconstruct/cuda_probe.hpp"

#include "reconstruct/cuda_device.hpp"

namespace rptv {

namespace {

__global__ void probe_kernel(int* out) { *out = 1; }

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

std::string error_text(cudaError_t error) {
  return std::string(cudaGetErrorName(error)) + ": " + cudaGetErrorString(error);
}

// Why no device can be asked for.
std::string no_device_text(cudaError_t error) {
  int runtime = 0, driver = 0;
  cudaRuntimeGetVersion(&runtime);
  cudaDriverGetVersion(&driver);
  if (driver == 0) return "no NVIDIA driver is installed; install one for CUDA " + version_text(runtime) + " or newer";
  if (driver < runtime)
    return "the NVIDIA driver is for CUDA " + version_text(driver) + " and this build needs " + version_text(runtime) +
           "; install a newer driver";
  if (error == cudaErrorNoDevice) return "the NVIDIA driver finds no GPU; see what nvidia-smi says";
  return "the NVIDIA driver refuses (" + error_text(error) + "); see what nvidia-smi says";
}

}  // namespace

CudaProbe probe_cuda() {
  CudaProbe probe;
  int devices = 0;
  const cudaError_t error = cudaGetDeviceCount(&devices);
  if (error != cudaSuccess || devices == 0) {
    probe.text = no_device_text(error == cudaSuccess ? cudaErrorNoDevice : error);
    static_cast<void>(cudaGetLastError());
    return probe;
  }
  for (int device = 0; device < devices; ++device) {
    cudaDeviceProp properties{};
    cudaFuncAttributes code{};
    cudaError_t failed = cudaGetDeviceProperties(&properties, device);
    if (failed == cudaSuccess) failed = cudaSetDevice(device);
    if (failed == cudaSuccess) failed = cudaFuncGetAttributes(&code, reinterpret_cast<const void*>(&probe_kernel));
    if (failed == cudaSuccess)
      return {true, device,
              std::string(properties.name) + ", " + std::to_string(properties.totalGlobalMem >> 20) + " MiB"};
    static_cast<void>(cudaGetLastError());
    probe.text += (probe.text.empty() ? "" : "; ") + std::string(properties.name) + " (compute capability " +
                  std::to_string(properties.major) + "." + std::to_string(properties.minor) + "): " +
                  (failed == cudaErrorNoKernelImageForDevice || failed == cudaErrorUnsupportedPtxVersion
                       ? "this build has no code for it, build with RPTV_CUDA_ARCHS"
                       : error_text(failed));
  }
  return probe;
}

}  // namespace rptv
