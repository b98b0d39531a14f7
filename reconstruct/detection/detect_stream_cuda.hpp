// SPDX-License-Identifier: MIT
// One camera's detector on the device: a frame goes up, its detections come back.
#pragma once

#include <cstdint>
#include "core/image.hpp"
#include "reconstruct/cuda_memory.hpp"
#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/detection/detect_device.hpp"
#include "reconstruct/detection/detections.hpp"
#include "reconstruct/detection/detector_counts.hpp"
#include "reconstruct/detection/detector_settings.hpp"
#include "reconstruct/detection/spots_cuda.hpp"

namespace rptv {

/// The settings for images of `shape`, 8 or 16 bit.
CudaSpotSettings cuda_spot_settings(const DetectorSettings& settings, const ImageShape& shape);

/// A stream with memory of its own. One thread; after construction nothing is allocated and nothing thrown.
class DetectStream {
 public:
  /// Images will have `shape`'s width and height. Throws Error(unavailable) for what is only_on_cpu(), and when the
  /// device has no room. `threads_per_block`: of the kernels, a multiple of 32.
  DetectStream(const DetectorSettings& settings, const ImageShape& shape, const DarkPixels& dark,
               unsigned threads_per_block = 128);

  /// Copies the image and queues the work; returns while the device works. The last one has been collected.
  void submit(const ImageView& image) noexcept;
  /// Waits for it, and replaces what is in `out` by what Detector finds, with the same bits. What does not fit is
  /// counted in out.overflow(); an image of another shape, or that the device refused, leaves `out` empty.
  void collect(Detections& out) noexcept;

  /// Totals since the start, as Detector::counts(); too_crowded stays 0.
  const DetectorCounts& counts() const noexcept { return counts_; }
  std::uint64_t failed() const noexcept { return failed_; }  ///< frames that the device refused: take_cuda_error()

 private:
  bool queue(const ImageView& image) noexcept;
  CudaSpots spots() const noexcept;

  const DetectorSettings settings_;
  const ImageShape shape_;
  const unsigned threads_;
  const bool uniform_;
  const std::size_t capacity_, most_maxima_;  // detections
  DeviceArray<std::uint16_t> pixels_, limit_;
  DeviceArray<float> mean_, centres_;
  DeviceArray<std::int32_t> columns_and_rows_;
  DeviceArray<std::uint32_t> row_start_, flags_, count_;
  DeviceArray<double> plateaus_, found_;
  DeviceArray<CudaSpotCounts> spot_counts_;
  struct Totals {
    std::uint32_t maxima, detections;
    CudaSpotCounts spots;
  };
  PinnedArray<std::uint16_t> image_;
  PinnedArray<double> columns_;
  PinnedArray<Totals> totals_;
  CudaStream stream_;
  enum class State { idle, queued, refused, failed } state_ = State::idle;
  DetectorCounts counts_;
  std::uint64_t failed_ = 0;
};

}  // namespace rptv
