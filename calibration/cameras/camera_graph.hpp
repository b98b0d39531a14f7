// SPDX-License-Identifier: MIT
// How cameras stand to each other, by the views that they share: pairs, the graph of pairs, and the best tree in it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "calibration/cameras/single_camera.hpp"

namespace rptv {

/// `a` after `b`: x = a.rotation·(b.rotation·y + b.translation) + a.translation.
CameraPose after(const CameraPose& a, const CameraPose& b);
CameraPose inverse(const CameraPose& pose);
/// Angle of a rotation, degrees.
double angle_deg(const Matrix3& rotation);

/// Two cameras that saw the target together.
struct CameraPair {
  std::size_t first = 0, second = 0;
  CameraPose second_from_first;
  std::size_t views = 0;   ///< that agree on the pose
  std::size_t points = 0;  ///< of the target, seen by both in those views
  double transfer_px = 0;  ///< median over the views: from the target's pose in one camera to pixels of the other
  std::vector<std::size_t> contradicting;  ///< views that put the cameras elsewhere

  /// Standard error of the pair's pose, in pixels: the tree has those with little of it.
  double error_px() const noexcept;
};

struct CameraGraph {
  std::size_t cameras = 0;
  double agree_px = 0;            ///< as given to link_cameras()
  std::size_t least_views = 1;    ///< agreeing or not, that make a pair: 3, or 1 of a target that is not flat
  std::vector<CameraPair> pairs;  ///< first < second
  std::size_t degree(std::size_t camera) const noexcept;
};

/// All pairs. The pose of a pair is the mean of those that its shared views agree on, to `agree_px` when one camera's
/// pose of the target is transferred to the other; views that `cameras` dropped are not used.
CameraGraph link_cameras(const BoardSet& set, std::span<const SingleCamera> cameras, double agree_px);

/// How far (px, rms) the second camera of a pair sees the target in a view from where the first one's pose of it puts
/// it; none where one of them has no pose of it.
std::optional<double> transfer_px(const BoardSet& set, std::span<const SingleCamera> cameras, const CameraPair& pair,
                                  std::size_t view);

/// Throws Error(bad_data) naming cameras and views: two cameras with one camera's images, images of two cameras
/// exchanged in some views (which agree with the others once they are changed back), pairs that agree in no way, a
/// camera that shares views with fewer than two others (of more than two).
void check_graph(const BoardSet& set, std::span<const SingleCamera> cameras, const CameraGraph& graph);

/// Poses of all cameras in the first one's frame, along the tree of pairs with the least error (Prim 1957). The graph
/// must have passed check_graph(); throws Error(bad_data) when it falls apart into two.
std::vector<CameraPose> register_cameras(const BoardSet& set, const CameraGraph& graph);

}  // namespace rptv
