// SPDX-License-Identifier: MIT
// Page-locking by the CUDA runtime.
#include "reconstruct/cuda_page_lock.hpp"

#include "reconstruct/cuda_device.hpp"

namespace rptv {

CudaPageLock::CudaPageLock(void* memory, std::size_t bytes) noexcept
    : memory_(cudaHostRegister(memory, bytes, cudaHostRegisterDefault) == cudaSuccess ? memory : nullptr) {
  if (memory_ == nullptr) static_cast<void>(cudaGetLastError());
}

CudaPageLock::~CudaPageLock() {
  if (memory_ != nullptr) cudaHostUnregister(memory_);
}

}  // namespace rptv
