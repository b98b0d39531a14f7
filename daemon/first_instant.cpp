// SPDX-License-Identifier: MIT
// Grey values of each camera's first image, and how many particle images become particles.
#include "daemon/first_instant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "reconstruct/multi_view/view_observer.hpp"
#include "replay/image_sequence.hpp"

namespace rptv {

namespace {

constexpr double kBlinded = 0.5;           // of the pixels
constexpr std::size_t kEnoughImages = 20;  // of particles, to expect that some meet
constexpr double kFewMeet = 0.1;           // of them

template <class Pixel>
std::string doubt_of(const ImageSequence& camera, const Pixel* pixels) {
  const std::size_t count = camera.shape().pixels();
  const auto [least, greatest] = std::minmax_element(pixels, pixels + count);
  const auto full_scale = static_cast<Pixel>((1U << camera.significant_bits()) - 1);
  const auto saturated =
      static_cast<double>(std::count_if(pixels, pixels + count, [&](Pixel grey) { return grey >= full_scale; })) /
      static_cast<double>(count);
  const std::string image = fmt::format("camera '{}', {}", camera.camera(), camera.file(0).string());
  if (saturated >= kBlinded)
    return fmt::format("{}: {:.0f} % of the image is saturated; shorten the exposure or close the aperture", image,
                       100 * saturated);
  if (*least == *greatest)
    return fmt::format("{}: every pixel is {}; look for a covered lens, a light that is off, or a wrong folder", image,
                       *least);
  return {};
}

/// How many particle images each camera sees.
struct ImageCounts final : ViewObserver {
  std::vector<std::size_t> seen;
  void see(std::span<const Detections> views) noexcept override {
    for (std::size_t c = 0; c < seen.size() && c < views.size(); ++c) seen[c] = views[c].size();
  }
};

/// Empty where enough of them meet, or there are too few to tell.
std::string doubt_of(std::vector<std::size_t> seen, std::size_t particles, std::size_t min_views) {
  std::sort(seen.rbegin(), seen.rend());
  const std::size_t most = seen[min_views - 1];  // particles that there may be
  if (most < kEnoughImages || static_cast<double>(particles) >= kFewMeet * static_cast<double>(most)) return {};
  return fmt::format(
      "{} cameras see {} and more particle images in the first instant, and {} sets of them meet in space: are cameras "
      "swapped, or have they moved since the calibration? Compare their names with the rig's, calibrate again, or "
      "raise "
      "multi_view.tolerance_px",
      min_views, most, particles);
}

}  // namespace

std::vector<std::string> doubts_of_first_instant(const Config& config, Reconstructor& stage) {
  std::vector<std::string> doubts;
  if (config.source.is_live() || !config.reconstruction.is_multi_view()) return doubts;
  const auto cameras = open_cameras(config.replay.path, config.replay.pattern);
  std::deque<FramePool> pools;
  FrameSet set;
  bool one_instant = true;
  for (const ImageSequence& camera : cameras) {
    Frame& frame = set.frames[set.cameras++];
    frame.shape = camera.shape();
    frame.lease = pools.emplace_back(1, frame.shape.bytes()).claim();
    ImageSequence::Reader(camera).decode(0, {frame.lease.get(), frame.shape.bytes()});
    one_instant = one_instant && camera.number(0) == cameras.front().number(0);
    const ImageView image = frame.view();
    std::string doubt =
        frame.shape.bytes_per_pixel == 1 ? doubt_of(camera, image.as_u8()) : doubt_of(camera, image.as_u16());
    if (!doubt.empty()) doubts.push_back(std::move(doubt));
  }
  if (auto* views = dynamic_cast<ObservableViews*>(&stage); views != nullptr && one_instant && doubts.empty()) {
    Particles found(config.max_particles());
    ImageCounts images;
    images.seen.resize(cameras.size());
    views->show_to(&images);
    stage.reconstruct(set, found);
    views->show_to(nullptr);
    std::string doubt = doubt_of(images.seen, found.size(), static_cast<std::size_t>(config.multi_view.min_views));
    if (!doubt.empty()) doubts.push_back(std::move(doubt));
  }
  return doubts;
}

}  // namespace rptv
