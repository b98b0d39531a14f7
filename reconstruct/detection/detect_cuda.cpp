// SPDX-License-Identifier: MIT
// All cameras submitted, then collected.
#include "reconstruct/detection/detect_cuda.hpp"

#include <deque>

#include "reconstruct/detection/detect_stream_cuda.hpp"

namespace rptv {

namespace {

class DetectCuda final : public DetectDevice {
 public:
  explicit DetectCuda(const DetectDevicePlan& plan) {
    for (std::size_t c = 0; c < plan.shapes.size(); ++c)
      streams_.emplace_back(plan.settings, plan.shapes[c], plan.dark[c]);
  }

  bool detect(std::span<const ImageView> images, std::span<Detections> seen) noexcept override {
    if (images.size() != streams_.size() || seen.size() != streams_.size()) return false;
    for (std::size_t c = 0; c < streams_.size(); ++c) streams_[c].submit(images[c]);
    std::uint64_t failed = 0;
    for (std::size_t c = 0; c < streams_.size(); ++c) {
      streams_[c].collect(seen[c]);
      failed += streams_[c].failed();
    }
    return failed == 0;
  }

 private:
  std::deque<DetectStream> streams_;
};

}  // namespace

std::unique_ptr<DetectDevice> make_detect_cuda(const DetectDevicePlan& plan) {
  return std::make_unique<DetectCuda>(plan);
}

}  // namespace rptv
