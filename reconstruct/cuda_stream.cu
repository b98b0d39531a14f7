// SPDX-License-Identifier: MIT
// Owners of streams and events over the CUDA runtime.
#include "reconstruct/cuda_stream.hpp"

#include "reconstruct/cuda_require.hpp"
#include "reconstruct/cuda_stage_timer.hpp"

namespace rptv {

namespace {

cudaStream_t stream_of(void* handle) noexcept { return static_cast<cudaStream_t>(handle); }
cudaEvent_t event_of(void* handle) noexcept { return static_cast<cudaEvent_t>(handle); }

}  // namespace

std::string take_cuda_error() {
  const cudaError_t error = cudaGetLastError();
  if (error == cudaSuccess) return {};
  return std::string(cudaGetErrorName(error)) + ": " + cudaGetErrorString(error);
}

CudaStream::CudaStream() : marks_(StageTimer::new_marks()) {
  cudaStream_t stream = nullptr;
  require_cuda(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "no stream");
  handle_ = stream;
}
CudaStream::~CudaStream() { cudaStreamDestroy(stream_of(handle_)); }

bool CudaStream::upload(void* device, const void* host, std::size_t bytes) noexcept {
  count_copy(bytes);
  return bytes == 0 || cudaMemcpyAsync(device, host, bytes, cudaMemcpyHostToDevice, stream_of(handle_)) == cudaSuccess;
}
bool CudaStream::download(void* host, const void* device, std::size_t bytes) noexcept {
  count_copy(bytes);
  return bytes == 0 || cudaMemcpyAsync(host, device, bytes, cudaMemcpyDeviceToHost, stream_of(handle_)) == cudaSuccess;
}
bool CudaStream::fill(void* device, unsigned char byte, std::size_t bytes) noexcept {
  count_copy(bytes);
  return bytes == 0 || cudaMemsetAsync(device, byte, bytes, stream_of(handle_)) == cudaSuccess;
}
bool CudaStream::wait_for(const CudaEvent& event) noexcept {
  return cudaStreamWaitEvent(stream_of(handle_), event_of(event.handle()), 0) == cudaSuccess;
}
bool CudaStream::synchronize() noexcept { return cudaStreamSynchronize(stream_of(handle_)) == cudaSuccess; }

bool CudaStream::timed() const noexcept { return marks_ != nullptr && marks_->recording(); }
void CudaStream::mark(CudaStage stage) noexcept { marks_->begin(stage, *this); }
void CudaStream::add(CudaStage stage, std::size_t bytes, std::uint64_t increments) noexcept {
  marks_->add(stage, bytes, increments);
}
void CudaStream::count_copy(std::size_t bytes) noexcept {
  if (marks_ != nullptr) marks_->add(marks_->now(), bytes, 0);
}

CudaEvent::CudaEvent(Use use) {
  cudaEvent_t event = nullptr;
  require_cuda(cudaEventCreateWithFlags(&event, use == Use::time ? cudaEventDefault : cudaEventDisableTiming),
               "no event");
  handle_ = event;
}
CudaEvent::~CudaEvent() { cudaEventDestroy(event_of(handle_)); }

bool CudaEvent::record(const CudaStream& stream) noexcept {
  return cudaEventRecord(event_of(handle_), stream_of(stream.handle())) == cudaSuccess;
}
bool CudaEvent::synchronize() noexcept { return cudaEventSynchronize(event_of(handle_)) == cudaSuccess; }
bool CudaEvent::time_to(const CudaEvent& end, float& elapsed_ms) const noexcept {
  return cudaEventElapsedTime(&elapsed_ms, event_of(handle_), event_of(end.handle())) == cudaSuccess;
}

}  // namespace rptv
