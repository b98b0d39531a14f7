// SPDX-License-Identifier: MIT
// Owners of device memory, streams and events over the CUDA runtime.
#include "reconstruct/cuda_memory.hpp"

#include "core/error.hpp"
#include "reconstruct/cuda_device.hpp"

namespace rptv {

namespace {

void require(cudaError_t result, const std::string& what) {
  if (result == cudaSuccess) return;
  cudaGetLastError();
  throw Error(ExitCode::unavailable, std::string("CUDA: ") + what + ": " + cudaGetErrorName(result) + " (" +
                                         cudaGetErrorString(result) + "); take reconstruction.backend = \"cpu\"");
}

cudaStream_t stream_of(void* handle) noexcept { return static_cast<cudaStream_t>(handle); }
cudaEvent_t event_of(void* handle) noexcept { return static_cast<cudaEvent_t>(handle); }

}  // namespace

std::string take_cuda_error() {
  const cudaError_t error = cudaGetLastError();
  if (error == cudaSuccess) return {};
  return std::string(cudaGetErrorName(error)) + ": " + cudaGetErrorString(error);
}

CudaBytes::CudaBytes(Place place, std::size_t bytes) : place_(place) {
  if (bytes == 0) return;
  if (place == Place::device)
    require(cudaMalloc(&data_, bytes), "no " + std::to_string(bytes) + " bytes on the device");
  else
    require(cudaMallocHost(&data_, bytes), "no " + std::to_string(bytes) + " page-locked bytes");
}

CudaBytes::~CudaBytes() {
  if (data_ == nullptr) return;
  if (place_ == Place::device)
    cudaFree(data_);
  else
    cudaFreeHost(data_);
}

CudaStream::CudaStream() {
  cudaStream_t stream = nullptr;
  require(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "no stream");
  handle_ = stream;
}
CudaStream::~CudaStream() { cudaStreamDestroy(stream_of(handle_)); }

bool CudaStream::upload(void* device, const void* host, std::size_t bytes) noexcept {
  return bytes == 0 || cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream_of(handle_)) == cudaSuccess;
}
bool CudaStream::download(void* host, const void* device, std::size_t bytes) noexcept {
  return bytes == 0 || cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, stream_of(handle_)) == cudaSuccess;
}
bool CudaStream::fill(void* device, unsigned char byte, std::size_t bytes) noexcept {
  return bytes == 0 || cudaMemsetAsync(device, byte, bytes, stream_of(handle_)) == cudaSuccess;
}
bool CudaStream::wait_for(const CudaEvent& event) noexcept {
  return cudaStreamWaitEvent(stream_of(handle_), event_of(event.handle()), 0) == cudaSuccess;
}
bool CudaStream::synchronize() noexcept { return cudaStreamSynchronize(stream_of(handle_)) == cudaSuccess; }

CudaEvent::CudaEvent() {
  cudaEvent_t event = nullptr;
  require(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), "no event");
  handle_ = event;
}
CudaEvent::~CudaEvent() { cudaEventDestroy(event_of(handle_)); }

bool CudaEvent::record(const CudaStream& stream) noexcept {
  return cudaEventRecord(event_of(handle_), stream_of(stream.handle())) == cudaSuccess;
}
bool CudaEvent::synchronize() noexcept { return cudaEventSynchronize(event_of(handle_)) == cudaSuccess; }

}  // namespace rptv
