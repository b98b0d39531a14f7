// SPDX-License-Identifier: MIT
// The detector's parts, and the order in which a frame goes through them.
#include "reconstruct/detection/detector.hpp"

#include <algorithm>
#include <optional>

#include "reconstruct/dark_pixels.hpp"
#include "reconstruct/detection/blob_finder.hpp"
#include "reconstruct/detection/detect_device.hpp"
#include "reconstruct/detection/spot_finder.hpp"
#include "reconstruct/running_background.hpp"

namespace rptv {

std::string only_on_cpu(const DetectorSettings& settings) {
  if (settings.method == "blob")
    return "detector.method = \"blob\"; take \"three_point\", \"centroid\" or \"gaussian\"";
  if (settings.method == "gaussian" && settings.overlap_sweeps > 0)
    return "detector.overlap_sweeps = " + std::to_string(settings.overlap_sweeps) +
           " with method = \"gaussian\"; take 0";
  if (settings.running_background) return "detector.running_background = true; take false";
  return {};
}

DarkSettings dark_settings(const DetectorSettings& settings, std::size_t camera) {
  const auto& names = settings.background_images;
  return {settings.background, std::max(settings.threshold, settings.threshold_sigmas * settings.noise_grey),
          camera < names.size() ? names[camera] : "the background image"};
}

struct Detector::Stages {
  Stages(const DetectorSettings& settings, const ImageShape& image_shape, const ImageView& background,
         std::size_t camera, InstructionSet set)
      : shape(image_shape), dark(make_dark(dark_settings(settings, camera), shape, background)) {
    if (settings.method == "blob")
      blobs.emplace(settings, shape, set);
    else
      spots.emplace(settings, shape, set);
    if (settings.running_background)
      learner = std::make_unique<RunningBackground>(
          shape, dark, settings.noise_grey, background.data != nullptr,
          RunningBackgroundOptions{settings.threshold, settings.threshold_sigmas, settings.background_frames});
  }

  template <class Pixel>
  void find(const ImageView& image, Detections& out) noexcept {
    const DarkPixels& now_dark = learner ? learner->dark() : dark;
    if (blobs)
      blobs->find<Pixel>(image, now_dark, out, counts);
    else
      spots->find<Pixel>(image, now_dark, out, counts);
  }

  const ImageShape shape;
  const DarkPixels dark;            // at the start
  std::optional<BlobFinder> blobs;  // one of the two
  std::optional<SpotFinder> spots;
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
  if (image.data == nullptr || !image.shape.has_size_of(s.shape)) {
    ++s.counts.refused_frames;
    return;
  }
  if (s.learner) s.learner->refresh();
  if (image.shape.bytes_per_pixel == 1)
    s.find<std::uint8_t>(image, out);
  else
    s.find<std::uint16_t>(image, out);
  if (s.learner) s.learner->offer(image);
  ++s.counts.frames;
}

}  // namespace rptv
