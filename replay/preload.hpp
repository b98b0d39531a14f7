// SPDX-License-Identifier: MIT
// A camera's images decoded into memory before the start.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "replay/image_sequence.hpp"

namespace rptv {

/// Called from the constructing thread during long set-up work.
using PreloadProgress = std::function<void(std::size_t done, std::size_t total)>;

/// All images of one camera, one after the other. Read-only after preload(): any thread.
struct DecodedImages {
  std::unique_ptr<std::byte[]> pixels;
  std::size_t bytes_per_image = 0;

  const std::byte* image(std::size_t i) const noexcept { return pixels.get() + i * bytes_per_image; }
};

/// Decodes every image of every camera on all processors. Throws Error: configuration when they need more than
/// `limit_mb` (10^6 bytes), unavailable when there is no memory, bad_data naming the file that cannot be decoded.
std::vector<DecodedImages> preload(const std::vector<ImageSequence>& cameras, std::int64_t limit_mb,
                                   const PreloadProgress& progress);

}  // namespace rptv
