// SPDX-License-Identifier: MIT
// Correspondence with a wide tolerance, frame by frame, without the choice that follows it in MultiView.
#include "reconstruct/multi_view/gather_disparities.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "calibration/space_algebra.hpp"
#include "reconstruct/multi_view/agreeing_sets.hpp"
#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/view_setup.hpp"

namespace rptv {
namespace {

constexpr double kBeyond = 1.1;  // of the maps' radius: none of the sets that vote in them is missed
constexpr std::size_t kMostSets = std::size_t{1} << 19;  // kept of all frames, shared out among the parts
constexpr double kDensest = 0.04;                        // images a square pixel at a radius of 1 px, by trial
constexpr double kSigma_px = 0.1;                        // of every detection: all weigh the same

std::size_t most_detections(std::span<const ParticleImages> frames) {
  std::size_t most = 1;
  for (const ParticleImages& frame : frames)
    for (const auto& view : frame) most = std::max(most, view.size());
  return most;
}

/// How many of a view's images are far enough apart.
std::size_t sparse_enough(const std::vector<ParticleImage>& view, double radius_px) {
  if (view.empty()) return 0;
  Pixel from = view.front().at_px, to = from;
  for (const ParticleImage& image : view)
    for (std::size_t k = 0; k < 2; ++k)
      from[k] = std::min(from[k], image.at_px[k]), to[k] = std::max(to[k], image.at_px[k]);
  const double area_px2 = (to[0] - from[0] + 1) * (to[1] - from[1] + 1);
  const double most = kDensest * area_px2 / std::pow(radius_px, 1.25);
  return most < static_cast<double>(view.size()) ? static_cast<std::size_t>(most) : view.size();
}

/// The brightest, in random order: where the work of a frame ends early, it has been spread over the whole image.
void choose(std::vector<ParticleImage> view, double radius_px, std::mt19937& random, Detections& seen) {
  const std::size_t chosen = sparse_enough(view, radius_px);
  std::shuffle(view.begin(), view.end(), random);
  std::nth_element(view.begin(), view.begin() + static_cast<std::ptrdiff_t>(chosen), view.end(),
                   [](const ParticleImage& a, const ParticleImage& b) { return a.grey > b.grey; });
  view.resize(chosen);
  std::shuffle(view.begin(), view.end(), random);
  seen.clear();
  for (const ParticleImage& image : view) seen.push({image.at_px[0], image.at_px[1], kSigma_px});
}

SetDisparities disparities_of(const Rig& rig, std::span<const Detections> seen, const ViewMatch& match,
                              const Point3& centre_mm) {
  SetDisparities set{centre_mm + match.at_mm, 0, {}};
  for (std::size_t c = 0; c < seen.size(); ++c) {
    const std::uint32_t i = match.tuple.detection[c];
    if (i == kUnseen) continue;
    const auto pixel = rig.cameras[c].model.project(set.at_mm);
    if (!pixel) continue;
    set.views |= 1U << c;
    set.px[c] = {static_cast<float>((*pixel)[0] - seen[c].x_px[i]), static_cast<float>((*pixel)[1] - seen[c].y_px[i])};
  }
  return set;
}

}  // namespace

ParticleImages images_of(std::span<const Detections> seen) {
  ParticleImages images;
  for (const Detections& view : seen) {
    auto& list = images.emplace_back();
    for (std::size_t i = 0; i < view.size(); ++i) list.push_back({{view.x_px[i], view.y_px[i]}, view.grey[i]});
  }
  return images;
}

std::uint64_t gather_disparities(const Rig& rig, const DisparitySearch& search, std::span<const ParticleImages> frames,
                                 DisparityMaps& maps) {
  return gather_disparities(rig, trace_views(rig, search.volume), search, frames, maps);
}

std::uint64_t gather_disparities(const Rig& rig, std::span<const ViewRays> rays, const DisparitySearch& search,
                                 std::span<const ParticleImages> frames, DisparityMaps& maps) {
  const std::size_t most = most_detections(frames);
  Correspondence correspondence(rays, search.volume,
                                {search.min_views, kBeyond * maps.radius_px(), most, search.most_matches});
  std::vector<Detections> seen;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) seen.emplace_back(most);
  std::vector<std::vector<SetDisparities>> parts(maps.grid().size());
  const std::size_t room = kMostSets / parts.size();
  std::mt19937 random(1);
  for (const ParticleImages& frame : frames) {
    for (std::size_t c = 0; c < seen.size(); ++c) choose(frame[c], maps.radius_px(), random, seen[c]);
    for (const ViewMatch& match : correspondence.match(seen)) {
      const SetDisparities set = disparities_of(rig, seen, match, search.volume.centre());
      const auto part = maps.grid().part_of(set.at_mm);
      if (part && parts[*part].size() < room) parts[*part].push_back(set);
    }
  }
  std::uint64_t added = 0;
  for (auto& sets : parts)
    for (const SetDisparities& set : agreeing_sets(sets, maps.radius_px())) {
      for (std::size_t c = 0; c < seen.size(); ++c)
        if ((set.views >> c & 1U) != 0) maps.add(c, set.at_mm, {set.px[c][0], set.px[c][1]});
      ++added;
    }
  return added;
}

}  // namespace rptv
