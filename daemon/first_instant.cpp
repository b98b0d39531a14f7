// SPDX-License-Identifier: MIT
// Names, grey values of each camera's first image, and how many particle images become particles.
#include "daemon/first_instant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <deque>

#include "calibration/cameras/rig.hpp"
#include "daemon/instants.hpp"
#include "daemon/meeting_views.hpp"
#include "daemon/session.hpp"
#include "replay/image_sequence.hpp"

namespace rptv {

namespace {

constexpr double kBlinded = 0.5;  // of the pixels

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

/// The rig's cameras that `cameras` lack.
std::vector<std::string> doubts_of_names(const Config& config, const std::vector<CameraInfo>& cameras) {
  std::vector<std::string> doubts;
  for (const RigCamera& known : read_rig(config.multi_view.rig).cameras)
    if (std::none_of(cameras.begin(), cameras.end(), [&](const CameraInfo& c) { return c.name == known.name; }))
      doubts.push_back(
          fmt::format("camera '{}' of {} has no images in {}: the run goes on with {}; add its images, or "
                      "name its folder as the rig does",
                      known.name, config.multi_view.rig, config.replay.path, cameras.size()));
  return doubts;
}

std::string doubt_of_meeting(const Config& config, const std::vector<CameraInfo>& cameras, const FrameSet& set) {
  Config plain = config;
  plain.multi_view.method = "detections", plain.reconstruction.backend = "cpu";
  const auto stage = make_reconstructor(plain, cameras);
  Particles found(plain.max_particles());
  stage->reconstruct(set, found);
  return doubt_of(meeting_of(dynamic_cast<MultiView&>(*stage), plain, cameras), plain, cameras);
}

}  // namespace

std::vector<std::string> doubts_of_first_instant(const Config& config) {
  if (config.source.is_live() || !config.reconstruction.is_multi_view()) return {};
  const auto sequences = open_cameras(config.replay.path, config.replay.pattern);
  const auto cameras = infos_of(sequences);
  std::vector<std::string> doubts = doubts_of_names(config, cameras);
  const std::size_t by_name = doubts.size();
  std::deque<FramePool> pools;
  FrameSet set;
  bool one_instant = true;
  for (const ImageSequence& camera : sequences) {
    Frame& frame = set.frames[set.cameras++];
    frame.shape = camera.shape();
    frame.lease = pools.emplace_back(1, frame.shape.bytes()).claim();
    ImageSequence::Reader(camera).decode(0, {frame.lease.get(), frame.shape.bytes()});
    one_instant = one_instant && camera.number(0) == sequences.front().number(0);
    const ImageView image = frame.view();
    std::string doubt =
        frame.shape.bytes_per_pixel == 1 ? doubt_of(camera, image.as_u8()) : doubt_of(camera, image.as_u16());
    if (!doubt.empty()) doubts.push_back(std::move(doubt));
  }
  if (!one_instant || doubts.size() > by_name) return doubts;
  if (std::string doubt = doubt_of_meeting(config, cameras, set); !doubt.empty()) doubts.push_back(std::move(doubt));
  return doubts;
}

}  // namespace rptv
