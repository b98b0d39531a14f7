// SPDX-License-Identifier: MIT
// The detector's parts, and the order in which a frame goes through them.
#include "reconstruct/detector.hpp"

#include <algorithm>

#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/running_background.hpp"
#include "reconstruct/spot_finder.hpp"

namespace rptv {

namespace {

DarkSettings dark_settings(const DetectorSettings& settings, std::size_t camera) {
  const auto& names = settings.background_images;
  return {settings.background, std::max(settings.threshold, settings.threshold_sigmas * settings.noise_grey),
          camera < names.size() ? names[camera] : "the background image"};
}

}  // namespace

struct Detector::Stages {
  Stages(const DetectorSettings& settings, const ImageShape& image_shape, const ImageView& background,
         std::size_t camera, InstructionSet set)
      : shape(image_shape), dark(make_dark(dark_settings(settings, camera), shape, background)), spots(settings, set) {
    if (settings.running_background)
      learner = std::make_unique<RunningBackground>(
          shape, dark, settings.noise_grey, background.data != nullptr,
          RunningBackgroundOptions{settings.threshold, settings.threshold_sigmas, settings.background_frames});
  }

  const ImageShape shape;
  const DarkPixels dark;  // at the start
  SpotFinder spots;
  std::unique_ptr<RunningBackground> learner;  // with settings.running_background
  DetectorCounts counts;
};

Detector::Detector(const DetectorSettings& settings, const ImageShape& shape, const ImageView& background,
                   std::size_t camera, InstructionSet set)
    : stages_(std::make_unique<Stages>(settings, shape, background, camera, set)) {}
Detector::~Detector() = default;
Detector::Detector(Detector&&) noexcept = default;
Detector& Detector::operator=(Detector&&) noexcept = default;

const DetectorCounts& Detector::counts() const noexcept { return stages_->counts; }

void Detector::detect(const ImageView& image, Detections& out) noexcept {
  auto& s = *stages_;
  out.clear();
  if (image.data == nullptr || image.shape.width_px != s.shape.width_px || image.shape.height_px != s.shape.height_px) {
    ++s.counts.refused_frames;
    return;
  }
  if (s.learner) s.learner->refresh();
  const DarkPixels& dark = s.learner ? s.learner->dark() : s.dark;
  if (image.shape.bytes_per_pixel == 1)
    s.spots.find<std::uint8_t>(image, dark, out, s.counts);
  else
    s.spots.find<std::uint16_t>(image, dark, out, s.counts);
  if (s.learner) s.learner->offer(image);
  ++s.counts.frames;
}

}  // namespace rptv
