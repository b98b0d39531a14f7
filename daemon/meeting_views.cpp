// SPDX-License-Identifier: MIT
// The same detections, matched as they are and with two cameras' exchanged.
#include "daemon/meeting_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace rptv {

namespace {

constexpr std::size_t kEnoughImages = 20;  // of particles, to expect that some meet
constexpr double kManyMeet = 0.5, kFewMeet = 0.1;
constexpr std::size_t kSwapFinds = 2;  // times as many

double share(std::size_t found, const Meeting& meeting) {
  return static_cast<double>(found) / static_cast<double>(meeting.expected);
}

std::vector<Detections> copies_of(std::span<const Detections> views) {
  std::vector<Detections> copies;
  for (const Detections& seen : views) {
    Detections& copy = copies.emplace_back(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i)
      copy.push({seen.x_px[i], seen.y_px[i], seen.sigma_px[i], seen.grey[i], seen.area_px[i], seen.angle_rad[i],
                 seen.long_px[i], seen.short_px[i]});
  }
  return copies;
}

}  // namespace

Meeting meeting_of(MultiView& stage, const Config& config, const std::vector<CameraInfo>& cameras) {
  std::vector<Detections> seen = copies_of(stage.detections());
  std::vector<std::size_t> counts;
  for (const Detections& view : seen) counts.push_back(view.size());
  std::sort(counts.rbegin(), counts.rend());
  Particles particles(config.max_particles());
  const auto match = [&] {
    stage.reconstruct(seen, particles);
    return particles.size();
  };
  Meeting meeting{counts[static_cast<std::size_t>(config.multi_view.min_views) - 1], match(), {}};
  if (meeting.expected < kEnoughImages || share(meeting.found, meeting) >= kManyMeet) return meeting;
  Meeting::Swap best;
  for (std::size_t one = 0; one < seen.size(); ++one)
    for (std::size_t other = one + 1; other < seen.size(); ++other) {
      if (!cameras[one].shape.has_size_of(cameras[other].shape)) continue;
      std::swap(seen[one], seen[other]);
      if (const std::size_t found = match(); found > best.found) best = {one, other, found};
      std::swap(seen[one], seen[other]);
    }
  if (best.found >= kSwapFinds * meeting.found && share(best.found, meeting) >= kManyMeet) meeting.swap = best;
  return meeting;
}

std::string doubt_of(const Meeting& m, const Config& config, const std::vector<CameraInfo>& cameras) {
  if (m.swap)
    return fmt::format(
        "cameras '{0}' and '{1}' are swapped: in the first instant {2} sets of particle images meet in space, and {3} "
        "with the two exchanged; exchange their names in {4}, or their images in {5}",
        cameras[m.swap->one].name, cameras[m.swap->other].name, m.found, m.swap->found, config.multi_view.rig,
        config.replay.path);
  if (m.expected < kEnoughImages || share(m.found, m) >= kFewMeet) return {};
  return fmt::format(
      "{} cameras see {} and more particle images in the first instant, and {} sets of them meet in space: are cameras "
      "swapped, or have they moved since the calibration? Compare their names with those in {}, calibrate again, or "
      "raise multi_view.tolerance_px",
      config.multi_view.min_views, m.expected, m.found, config.multi_view.rig);
}

}  // namespace rptv
