// SPDX-License-Identifier: MIT
// What a graph of cameras shows to be wrong with the images, said in one line.
#include <fmt/format.h>

#include <algorithm>

#include "calibration/cameras/camera_graph.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr double kSamePlace_deg = 0.05, kSamePlace = 1e-3;  // angle; distance, of that to the target

[[noreturn]] void refuse(const std::string& text) { throw Error(ExitCode::bad_data, text); }

std::string names_of(const BoardSet& set, const std::vector<std::size_t>& views) {
  constexpr std::size_t kMost = 6;
  std::string text = views.size() == 1 ? "view " : "views ";
  for (std::size_t i = 0; i < std::min(views.size(), kMost); ++i) text += (i > 0 ? ", " : "") + set.views[views[i]];
  return text + (views.size() > kMost ? fmt::format(" and {} more", views.size() - kMost) : "");
}

/// The set with the images of two cameras exchanged in one view, and the poses that follow.
struct Exchanged {
  BoardSet set;
  std::vector<SingleCamera> cameras;

  Exchanged(const BoardSet& from, std::span<const SingleCamera> singles, std::size_t a, std::size_t b, std::size_t view)
      : set(from), cameras(singles.begin(), singles.end()) {
    for (auto& image : set.images)
      if (image.view == view && (image.camera == a || image.camera == b)) {
        image.camera = image.camera == a ? b : a;
        cameras[image.camera].target[view] = target_pose(cameras[image.camera].lens, set.target_mm, image.seen);
      }
  }
};

bool contradicts(const CameraGraph& graph, std::size_t view) {
  return std::any_of(graph.pairs.begin(), graph.pairs.end(), [&](const CameraPair& p) {
    return std::find(p.contradicting.begin(), p.contradicting.end(), view) != p.contradicting.end();
  });
}

using Pair = std::pair<std::size_t, std::size_t>;

/// The pair whose exchange makes `view` agree with what the others say of all pairs, if there is one.
std::optional<Pair> exchanged_pair(const BoardSet& set, std::span<const SingleCamera> cameras, const CameraGraph& graph,
                                   std::size_t view) {
  for (const auto& pair : graph.pairs) {
    const Exchanged other(set, cameras, pair.first, pair.second, view);
    if (std::all_of(graph.pairs.begin(), graph.pairs.end(), [&](const CameraPair& p) {
          return transfer_px(other.set, other.cameras, p, view).value_or(0) <= graph.agree_px;
        }))
      return Pair{pair.first, pair.second};
  }
  return std::nullopt;
}

void check_exchanged(const BoardSet& set, std::span<const SingleCamera> cameras, const CameraGraph& graph) {
  std::optional<Pair> swapped;
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < set.views.size(); ++v) {
    if (!contradicts(graph, v)) continue;
    const auto pair = exchanged_pair(set, cameras, graph, v);
    if (!pair || (swapped && *swapped != *pair)) continue;
    swapped = pair, views.push_back(v);
  }
  if (swapped)
    refuse(
        fmt::format("cameras {} and {} are swapped in {}: with the images of the two exchanged there, they "
                    "agree with the others; rename those files",
                    set.cameras[swapped->first].name, set.cameras[swapped->second].name, names_of(set, views)));
}

void check_same_place(const BoardSet& set, std::span<const SingleCamera> cameras, const CameraGraph& graph) {
  for (const auto& pair : graph.pairs) {
    double far_mm = 0;
    for (const auto& target : cameras[pair.first].target)
      if (target) far_mm = std::max(far_mm, norm(target->translation_mm));
    if (pair.views > 0 && angle_deg(pair.second_from_first.rotation) < kSamePlace_deg &&
        norm(pair.second_from_first.translation_mm) < kSamePlace * far_mm)
      refuse(
          fmt::format("cameras {} and {} stand at the same place: the images of one were given as the other's; "
                      "check the names of the files",
                      set.cameras[pair.first].name, set.cameras[pair.second].name));
  }
}

}  // namespace

void check_graph(const BoardSet& set, std::span<const SingleCamera> cameras, const CameraGraph& graph) {
  check_same_place(set, cameras, graph);
  check_exchanged(set, cameras, graph);
  for (const auto& pair : graph.pairs)
    if (!pair.contradicting.empty())
      refuse(fmt::format(
          "cameras {} and {} contradict each other in {}: there they would stand elsewhere than in {} "
          "other views; take the images of a view at one time, with the target at rest, or leave the "
          "view out",
          set.cameras[pair.first].name, set.cameras[pair.second].name, names_of(set, pair.contradicting), pair.views));
  const std::size_t least = std::min<std::size_t>(2, graph.cameras - 1);
  for (std::size_t c = 0; c < graph.cameras; ++c)
    if (const std::size_t degree = graph.degree(c); degree < least)
      refuse(
          fmt::format("camera {} sees the target together with {} other camera{} in {} or more views and needs {}; "
                      "take views of it that two others see as well",
                      set.cameras[c].name, degree, degree == 1 ? "" : "s", graph.least_views, least));
}

}  // namespace rptv
