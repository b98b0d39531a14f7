// SPDX-License-Identifier: MIT
// Checks launches against the limits of the device and queues them.
#include <algorithm>

#include "tests/cuda_host/control.hpp"
#include "tests/cuda_host/device_limits.hpp"
#include "tests/cuda_host/launch.hpp"
#include "tests/cuda_host/ptx_kernels.hpp"
#include "tests/cuda_host/runtime.hpp"

namespace rptv::cuda_host {
namespace {

std::string size_text(dim3 size) { return printed(uint3{size.x, size.y, size.z}); }

/// What is wrong with a launch; empty if nothing.
std::string wrong_with(const cudaLaunchConfig_t& config, std::size_t shared_limit_bytes) {
  const dim3 grid = config.gridDim;
  const dim3 block = config.blockDim;
  if (grid.x == 0 || grid.y == 0 || grid.z == 0) return "the grid " + size_text(grid) + " has no block";
  if (grid.x > kMaxGridX || grid.y > kMaxGridYz || grid.z > kMaxGridYz) {
    return "the grid " + size_text(grid) + " is larger than (2147483647,65535,65535)";
  }
  if (block.x == 0 || block.y == 0 || block.z == 0) return "the block " + size_text(block) + " has no thread";
  if (block.x > kMaxThreads || block.y > kMaxThreads || block.z > kMaxBlockZ ||
      std::size_t{block.x} * block.y * block.z > kMaxThreads) {
    return "the block " + size_text(block) + " is larger than 1024 threads or (1024,1024,64)";
  }
  if (config.dynamicSmemBytes > shared_limit_bytes) {
    return std::to_string(config.dynamicSmemBytes) + " bytes of dynamic shared memory; the kernel may take " +
           std::to_string(shared_limit_bytes) + " (more by cudaFuncSetAttribute, up to 65536 on every device)";
  }
  return {};
}

}  // namespace

cudaError_t enqueue_kernel(const cudaLaunchConfig_t& config, const void* kernel, std::function<void()> body,
                           const ArgumentView* arguments, std::size_t count) {
  return call([&](Runtime& device) {
    if (runs_ptx()) {
      try {
        body = ptx_body(kernel, arguments, count);
      } catch (const PtxError& error) {
        return device.blame(cudaErrorInvalidDeviceFunction, error.what());
      }
    }
    const auto raised = device.dynamic_limit_bytes.find(kernel);
    const std::size_t limit_bytes =
        raised == device.dynamic_limit_bytes.end() ? kSharedBytes : std::max(kSharedBytes, raised->second);
    const std::string wrong = wrong_with(config, limit_bytes);
    if (!wrong.empty()) return device.blame(cudaErrorInvalidConfiguration, "launch: " + wrong);
    const Block::Shape shape{config.blockDim, config.dynamicSmemBytes, limit_bytes};
    const dim3 grid = config.gridDim;
    Operation operation;
    operation.execute = [&device, grid, shape, body = std::move(body)] {
      if (device.launch_failed) return;
      std::string fault = device.grid.run(grid, shape, device.seed, body);
      if (fault.empty()) return;
      device.launch_failed = true;
      device.blame(cudaErrorLaunchFailure, std::move(fault));
    };
    device.push(config.stream, std::move(operation));
    return cudaSuccess;
  });
}

bool reachable_from_device(const void* pointer, std::size_t parameter) {
  Runtime& device = runtime();
  const std::lock_guard<std::mutex> turn(device.mutex);
  if (pointer == nullptr || device.memory.holds_or_ends(pointer) || device.pinned.hold(pointer, 1)) return true;
  device.last_error =
      device.blame(cudaErrorInvalidValue, "launch: argument " + std::to_string(parameter) +
                                              " points to memory that only the host has, or that was freed");
  return false;
}

}  // namespace rptv::cuda_host
