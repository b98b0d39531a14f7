// SPDX-License-Identifier: MIT
// The launch of a kernel: its arguments are copied now, it runs when somebody waits for its stream.
#pragma once

#include <cstddef>
#include <functional>
#include <tuple>
#include <type_traits>
#include <utility>

#include "tests/cuda_host/stream_api.hpp"
#include "tests/cuda_host/vector_types.hpp"

struct cudaLaunchAttribute {
  int id;
};

struct cudaLaunchConfig_t {
  dim3 gridDim;
  dim3 blockDim;
  std::size_t dynamicSmemBytes;
  cudaStream_t stream;
  cudaLaunchAttribute* attrs;
  unsigned numAttrs;
};

namespace rptv::cuda_host {

/// One argument of a launch as the kernel takes it.
struct ArgumentView {
  const void* value;
  std::size_t size_bytes;
};

/// Queues the kernel, or says at once what is wrong with the launch. `arguments` are those that `body` holds.
cudaError_t enqueue_kernel(const cudaLaunchConfig_t& config, const void* kernel, std::function<void()> body,
                           const ArgumentView* arguments, std::size_t count);

/// Notes a fault and returns false where a kernel is given memory that only the host has.
bool reachable_from_device(const void* pointer, std::size_t parameter);

template <class T>
bool reachable(const T& argument, std::size_t parameter) {
  if constexpr (std::is_pointer_v<T>) return reachable_from_device(argument, parameter);
  return true;
}

}  // namespace rptv::cuda_host

template <class... Parameters, class... Arguments>
cudaError_t cudaLaunchKernelEx(const cudaLaunchConfig_t* config, void (*kernel)(Parameters...),
                               Arguments&&... arguments) {
  static_assert((std::is_trivially_copyable_v<Parameters> && ...), "arguments travel to the device as bytes");
  static_assert((sizeof(Parameters) + ... + 0) <= 4096, "a kernel takes at most 4096 bytes of arguments");
  return [&](Parameters... converted) {
    std::size_t parameter = 0;
    const bool all_reachable = (rptv::cuda_host::reachable(converted, parameter++) && ... && true);
    if (!all_reachable) return cudaErrorInvalidValue;
    const auto body = [kernel, values = std::tuple<Parameters...>(converted...)] { std::apply(kernel, values); };
    const rptv::cuda_host::ArgumentView arguments_now[] = {{&converted, sizeof converted}..., {nullptr, 0}};
    return rptv::cuda_host::enqueue_kernel(*config, reinterpret_cast<const void*>(kernel), body, arguments_now,
                                           sizeof...(Parameters));
  }(std::forward<Arguments>(arguments)...);
}
