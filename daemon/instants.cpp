// SPDX-License-Identifier: MIT
// A pool of one frame a camera, filled by its reader.
#include "daemon/instants.hpp"

namespace rptv {

std::vector<CameraInfo> infos_of(const std::vector<ImageSequence>& cameras) {
  std::vector<CameraInfo> infos;
  for (const ImageSequence& camera : cameras)
    infos.push_back({camera.camera(), camera.shape(), camera.significant_bits()});
  return infos;
}

Instants::Instants(const std::vector<ImageSequence>& cameras) {
  set_.cameras = static_cast<std::uint32_t>(cameras.size());
  for (const ImageSequence& camera : cameras) {
    pools_.emplace_back(1, camera.shape().bytes());
    readers_.emplace_back(camera);
    set_.frames[pools_.size() - 1].shape = camera.shape();
  }
}

const FrameSet& Instants::load(const Timeline& timeline, std::size_t instant) {
  for (std::size_t c = 0; c < pools_.size(); ++c) {
    Frame& frame = set_.frames[c];
    frame.lease.reset();
    const std::size_t image = timeline.shots[c][instant].image;
    if (image == Shot::kNone) continue;
    frame.lease = pools_[c].claim();
    readers_[c].decode(image, {frame.lease.get(), frame.shape.bytes()});
  }
  return set_;
}

}  // namespace rptv
