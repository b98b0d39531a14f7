// SPDX-License-Identifier: MIT
// Sets of frames made of image files or of pixels, as a source would deliver them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "core/frame.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "replay/image_file.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv::testing {

/// One frame per camera, which stays until it is loaded anew.
class CameraFrames {
 public:
  CameraFrames(const ImageShape& shape, std::uint32_t cameras) : shape_(shape) {
    set_.cameras = cameras;
    for (std::uint32_t c = 0; c < cameras; ++c) {
      pools_.emplace_back(1, shape.bytes());
      Frame& frame = set_.frames[c];
      frame.info.camera = c;
      frame.shape = shape;
      frame.lease = pools_.back().claim();
    }
  }
  ~CameraFrames() { set_.reset(); }

  void load(std::size_t camera, const std::filesystem::path& file) {
    open_image(file)->decode(0, {set_.frames[camera].lease.get(), shape_.bytes()});
  }
  void fill(std::size_t camera, int grey) { std::memset(set_.frames[camera].lease.get(), grey, shape_.bytes()); }
  std::byte* pixels(std::size_t camera) { return set_.frames[camera].lease.get(); }

  FrameSet& set() { return set_; }
  /// Named `prefix` and a number from `first` on.
  std::vector<MultiViewCamera> views(const std::string& prefix, std::size_t first) const {
    std::vector<MultiViewCamera> views;
    for (std::size_t c = 0; c < set_.cameras; ++c) views.push_back({prefix + std::to_string(first + c), shape_, {}});
    return views;
  }

 private:
  ImageShape shape_;
  std::deque<FramePool> pools_;
  FrameSet set_;
};

/// Spots of a Gaussian profile where a scene's particles are seen; frames of 1920 × 1200 px.
inline void paint(const ViewScene& scene, CameraFrames& frames) {
  for (std::size_t v = 0; v < scene.detections.size(); ++v) {
    frames.fill(v, 10);
    const Detections& seen = scene.detections[v];
    for (std::size_t i = 0; i < seen.size(); ++i) {
      const int x0 = static_cast<int>(std::lround(seen.x_px[i])), y0 = static_cast<int>(std::lround(seen.y_px[i]));
      for (int y = std::max(y0 - 6, 0); y <= std::min(y0 + 6, 1199); ++y)
        for (int x = std::max(x0 - 6, 0); x <= std::min(x0 + 6, 1919); ++x) {
          const double square = std::pow(x - seen.x_px[i], 2) + std::pow(y - seen.y_px[i], 2);
          std::byte& pixel = frames.pixels(v)[y * 1920 + x];
          const double grey = static_cast<double>(pixel) + 180 * std::exp(-square / (2 * 1.4 * 1.4));
          pixel = static_cast<std::byte>(std::lround(std::min(grey, 255.0)));
        }
    }
  }
}

}  // namespace rptv::testing
