// SPDX-License-Identifier: MIT
// Owners of memory over the CUDA runtime.
#include "reconstruct/cuda_memory.hpp"

#include "reconstruct/cuda_require.hpp"

namespace rptv {

CudaBytes::CudaBytes(Place place, std::size_t bytes) : place_(place) {
  if (bytes == 0) return;
  if (place == Place::device)
    require_cuda(cudaMalloc(&data_, bytes), "no " + std::to_string(bytes) + " bytes on the device");
  else
    require_cuda(cudaMallocHost(&data_, bytes), "no " + std::to_string(bytes) + " page-locked bytes");
}

CudaBytes::~CudaBytes() {
  if (data_ == nullptr) return;
  if (place_ == Place::device)
    cudaFree(data_);
  else
    cudaFreeHost(data_);
}

}  // namespace rptv
