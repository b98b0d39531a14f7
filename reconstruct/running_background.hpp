// SPDX-License-Identifier: MIT
// Background and thresholds that follow the experiment: learned from the running images on a thread of their own.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "core/image.hpp"
#include "core/triple_buffer.hpp"
#include "core/wake.hpp"
#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/pixel_statistics.hpp"

namespace rptv {

struct RunningBackgroundOptions {
  double threshold = 0;         ///< at least this above the mean, grey values
  double threshold_sigmas = 0;  ///< and at least this many of the pixel's own noise
  std::int64_t window = 100;    ///< images that count
  std::vector<float> share{};   ///< of `threshold` that counts in each pixel, as KnownPixels::share; empty: all of it
};

/// offer(), refresh(), dark(): the reconstructing thread; none waits, allocates or locks. Each image gives a strip of
/// its rows, copied when the learner is free; once the strips have come round, new limits are published.
class RunningBackground {
 public:
  static constexpr std::uint32_t kStrips = 16;

  /// Starts from `initial` with the noise `sigma` (grey values).
  RunningBackground(const ImageShape& shape, const DarkPixels& initial, double sigma, bool initial_is_image,
                    const RunningBackgroundOptions& options);
  ~RunningBackground();
  RunningBackground(const RunningBackground&) = delete;
  RunningBackground& operator=(const RunningBackground&) = delete;

  /// Gives the learner its next strip of this image, if it is free.
  void offer(const ImageView& image) noexcept;
  /// Takes the newest limits; true when they changed.
  bool refresh() noexcept { return dark_.refresh(); }
  const DarkPixels& dark() const noexcept { return dark_.front(); }
  std::uint64_t published() const noexcept { return published_.load(std::memory_order_relaxed); }

 private:
  void learn() noexcept;
  void take_strip() noexcept;
  void publish() noexcept;

  const ImageShape shape_;
  const RunningBackgroundOptions options_;
  PixelStatistics statistics_;
  TripleBuffer<DarkPixels> dark_;
  std::vector<std::byte> strip_;
  std::uint32_t next_strip_ = 0, strip_bytes_per_pixel_ = 1;
  std::atomic<bool> full_{false}, ending_{false};
  std::atomic<std::uint64_t> published_{0};
  Wake wake_;
  std::thread learner_;
};

}  // namespace rptv
