// SPDX-License-Identifier: MIT
// Copies and fills: what they name is checked when they are given, the bytes move when somebody waits.
#include <cstring>

#include "tests/cuda_host/memory_api.hpp"
#include "tests/cuda_host/runtime.hpp"

using namespace rptv::cuda_host;

namespace {

/// Rows of a copy; one for those that have none.
struct Rectangle {
  void* to;
  std::size_t to_pitch_bytes;
  const void* from;
  std::size_t from_pitch_bytes;
  std::size_t width_bytes, rows;

  std::size_t to_bytes() const { return (rows - 1) * to_pitch_bytes + width_bytes; }
  std::size_t from_bytes() const { return (rows - 1) * from_pitch_bytes + width_bytes; }
};

/// What is wrong with a copy; empty if nothing.
std::string wrong_with(const Runtime& device, const Rectangle& copy, cudaMemcpyKind kind) {
  const bool to_device = device.memory.holds(copy.to);
  const bool from_device = device.memory.holds(copy.from);
  const int found = (from_device ? 2 : 0) + (to_device ? 1 : 0);  // as cudaMemcpyKind counts
  static const char* const kNames[] = {"host to host", "host to device", "device to host", "device to device"};
  if (kind != cudaMemcpyDefault && found != kind) {
    return std::string("it says ") + kNames[kind] + ", but goes from " + kNames[found];
  }
  if (copy.rows > 1 && (copy.to_pitch_bytes < copy.width_bytes || copy.from_pitch_bytes < copy.width_bytes)) {
    return "a row is longer than the distance of rows";
  }
  if (to_device && !device.memory.holds(copy.to, copy.to_bytes())) {
    return "it writes " + std::to_string(copy.to_bytes()) + " bytes, past the end of the device memory block";
  }
  if (from_device && !device.memory.holds(copy.from, copy.from_bytes())) {
    return "it reads " + std::to_string(copy.from_bytes()) + " bytes, past the end of the device memory block";
  }
  return {};
}

cudaError_t copy_rows(const Rectangle& copy, cudaMemcpyKind kind, cudaStream_t stream, bool wait) {
  return call([&](Runtime& device) {
    if (copy.width_bytes == 0 || copy.rows == 0) return cudaSuccess;
    const std::string wrong = wrong_with(device, copy, kind);
    if (!wrong.empty()) return device.blame(cudaErrorInvalidValue, "copy: " + wrong);
    Operation operation;
    bool pageable = false;
    const auto note_host_side = [&](const void* side, std::size_t bytes) {
      if (device.memory.holds(side)) return;
      if (!device.pinned.hold(side, bytes)) pageable = true;
      operation.host_memory = side;
      operation.host_bytes = bytes;
    };
    note_host_side(copy.to, copy.to_bytes());
    note_host_side(copy.from, copy.from_bytes());
    if (pageable && device.at(stream).capture != nullptr) {
      return device.blame(cudaErrorStreamCaptureUnsupported, "copy: a graph cannot hold a copy of pageable memory");
    }
    operation.execute = [&device, copy] {
      if (device.launch_failed) return;
      for (std::size_t row = 0; row < copy.rows; ++row) {
        std::memcpy(static_cast<unsigned char*>(copy.to) + row * copy.to_pitch_bytes,
                    static_cast<const unsigned char*>(copy.from) + row * copy.from_pitch_bytes, copy.width_bytes);
      }
    };
    device.push(stream, std::move(operation));
    return wait || pageable ? device.run(device.end_of(stream)) : cudaSuccess;
  });
}

cudaError_t fill(void* to, int value, std::size_t bytes, cudaStream_t stream) {
  return call([&](Runtime& device) {
    if (bytes == 0) return cudaSuccess;
    if (!device.memory.holds(to, bytes)) {
      return device.blame(cudaErrorInvalidValue,
                          "fill: " + std::to_string(bytes) + " bytes are not all in one block of device memory");
    }
    Operation operation;
    operation.execute = [&device, to, value, bytes] {
      if (!device.launch_failed) std::memset(to, value, bytes);
    };
    device.push(stream, std::move(operation));
    return cudaSuccess;
  });
}

}  // namespace

cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
  return copy_rows({to, bytes, from, bytes, bytes, 1}, kind, nullptr, true);
}

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind, cudaStream_t stream) {
  return copy_rows({to, bytes, from, bytes, bytes, 1}, kind, stream, false);
}

cudaError_t cudaMemcpy2DAsync(void* to, std::size_t to_pitch_bytes, const void* from, std::size_t from_pitch_bytes,
                              std::size_t width_bytes, std::size_t rows, cudaMemcpyKind kind, cudaStream_t stream) {
  return copy_rows({to, to_pitch_bytes, from, from_pitch_bytes, width_bytes, rows}, kind, stream, false);
}

cudaError_t cudaMemset(void* to, int value, std::size_t bytes) { return fill(to, value, bytes, nullptr); }

cudaError_t cudaMemsetAsync(void* to, int value, std::size_t bytes, cudaStream_t stream) {
  return fill(to, value, bytes, stream);
}
