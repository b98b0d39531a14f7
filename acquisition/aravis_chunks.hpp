// SPDX-License-Identifier: MIT
// Chunk data: what a camera writes into a buffer behind the image; for the aravis_*.cpp files only.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/aravis_handle.hpp"
#include "core/device_status.hpp"

typedef struct _ArvChunkParser ArvChunkParser;

namespace rptv {

/// Reads chunks of the next image after each ask(), as looking them up in the camera's description takes time and
/// memory that not every image should cost.
class AravisChunks {
 public:
  /// `names` without "Chunk": "ExposureTime". Throws Error(configuration) for one that the camera does not describe, or
  /// that is no number.
  AravisChunks(ArvCamera* camera, const std::string& camera_name, const std::vector<std::string>& names);

  /// Any thread.
  void ask() noexcept { asked_.store(!chunks_.empty(), std::memory_order_relaxed); }
  bool asked() const noexcept { return asked_.load(std::memory_order_relaxed); }
  /// Of the image with this index. One thread at a time: the receiving one.
  void read(ArvBuffer* buffer, std::uint64_t index) noexcept;
  /// Those that the last image read did not hold are left out. Any thread.
  DeviceReadings latest() const;

 private:
  enum class Kind { integer, real, truth };
  struct Chunk {
    std::string name, feature;
    Kind kind;
    std::atomic<double> value;
    Chunk(const std::string& n, Kind k);
  };
  double value_of(const Chunk& chunk, ArvBuffer* buffer) const noexcept;

  std::unique_ptr<ArvChunkParser, DropObject> parser_;
  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::atomic<bool> asked_{false};
  std::atomic<std::uint64_t> writes_{0}, frame_{0};  // odd writes_: values are being written, by the one writer
};

}  // namespace rptv
