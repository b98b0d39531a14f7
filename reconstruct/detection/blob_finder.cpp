// SPDX-License-Identifier: MIT
// Components to blobs: those of the right size and within the image, and the moments of their parts.
#include "reconstruct/detection/blob_finder.hpp"

#include <algorithm>
#include <cmath>

namespace rptv {

namespace {
constexpr std::size_t kRunsPerDetection = 64;
}

BlobFinder::BlobFinder(const DetectorSettings& settings, const ImageShape& shape, InstructionSet set)
    : set_(set),
      noise_(GreyNoise::of(settings.noise_grey, settings.electrons_per_grey)),
      min_area_px_(static_cast<std::size_t>(settings.min_area_px)),
      max_area_px_(static_cast<std::size_t>(settings.max_area_px)),
      components_(kRunsPerDetection * static_cast<std::size_t>(settings.max_detections)),
      parts_(shape, max_area_px_, settings.split_sigmas, noise_) {
  runs_.reserve(kRunsPerDetection * static_cast<std::size_t>(settings.max_detections));
  moments_.reserve(max_area_px_);
}

bool BlobFinder::is_whole(std::span<const LitRun> component, const ImageShape& shape,
                          DetectorCounts& counts) const noexcept {
  std::size_t area = 0;
  bool at_border = component.front().y == 0 || component.back().y + 1 == shape.height_px;
  for (const LitRun& run : component) {
    area += run.end_x - run.first_x;
    at_border |= run.first_x == 0 || run.end_x == shape.width_px;
  }
  if (area < min_area_px_) return ++counts.too_small, false;
  if (area > max_area_px_) return ++counts.too_large, false;
  counts.at_border += at_border;
  return !at_border;
}

void BlobFinder::measure(const LitRun& origin, std::uint32_t parts) noexcept {
  moments_.assign(parts, {});
  for (const PartPixel& p : parts_.pixels()) {
    Moments& m = moments_[p.part];
    const double x = static_cast<double>(p.x) - origin.first_x, y = static_cast<double>(p.y) - origin.y;
    const double light = static_cast<double>(p.over_limit);
    const double noise = static_cast<double>(noise_.variance(p.over_background));
    ++m.pixels, m.grey += static_cast<double>(p.over_background);
    m.light += light, m.x += light * x, m.y += light * y;
    m.xx += light * x * x, m.xy += light * x * y, m.yy += light * y * y;
    m.noise += noise, m.noise_x += noise * x, m.noise_y += noise * y, m.noise_rr += noise * (x * x + y * y);
  }
}

// The centre is that of the light over the limit: it falls to zero at the edge, where a pixel is in by chance, so that
// the noise of the pixels is all that the centre has.
void BlobFinder::push(const LitRun& origin, const Moments& m, Detections& out, DetectorCounts& counts) const noexcept {
  if (m.pixels < static_cast<double>(min_area_px_)) {
    ++counts.too_small;
    return;
  }
  const double x = m.x / m.light, y = m.y / m.light;
  const double xx = m.xx / m.light - x * x, yy = m.yy / m.light - y * y, xy = m.xy / m.light - x * y;
  const double middle = (xx + yy) / 2, half = std::hypot((xx - yy) / 2, xy);
  const double spread = m.noise_rr - 2 * (x * m.noise_x + y * m.noise_y) + (x * x + y * y) * m.noise;
  Detection found;
  found.x_px = origin.first_x + x, found.y_px = origin.y + y;
  found.sigma_px = std::sqrt(spread / 2) / m.light;
  found.grey = m.grey, found.area_px = m.pixels;
  found.angle_rad = std::atan2(2 * xy, xx - yy) / 2;
  found.long_px = std::sqrt(middle + half), found.short_px = std::sqrt(std::max(middle - half, 0.0));
  out.push(found);
}

template <class Pixel>
void BlobFinder::find(const ImageView& image, const DarkPixels& dark, Detections& out,
                      DetectorCounts& counts) noexcept {
  const GreyOverBackground<Pixel> grey(image, dark, 0);
  const std::size_t all = find_lit_runs(image, dark.limit, runs_, set_);
  counts.refused_runs += all - runs_.size();
  out.refuse(all - runs_.size());
  components_.join(runs_);
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const std::span<const LitRun> component = components_[i];
    if (!is_whole(component, image.shape, counts)) continue;
    const std::uint32_t parts = parts_.take_apart(grey, component);
    measure(component.front(), parts);
    for (const Moments& m : moments_) push(component.front(), m, out, counts);
  }
}

template void BlobFinder::find<std::uint8_t>(const ImageView&, const DarkPixels&, Detections&,
                                             DetectorCounts&) noexcept;
template void BlobFinder::find<std::uint16_t>(const ImageView&, const DarkPixels&, Detections&,
                                              DetectorCounts&) noexcept;

}  // namespace rptv
