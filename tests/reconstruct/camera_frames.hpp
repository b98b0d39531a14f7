// SPDX-License-Identifier: MIT
// Sets of frames made of image files or of pixels, as a source would deliver them.
#pragma once

#include <cstring>
#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "core/frame.hpp"
#include "reconstruct/multi_view.hpp"
#include "replay/image_file.hpp"

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

}  // namespace rptv::testing
