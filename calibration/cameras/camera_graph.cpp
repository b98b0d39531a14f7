// SPDX-License-Identifier: MIT
// Relative poses from shared views, agreed upon by transfer errors; Prim's tree.
#include "calibration/cameras/camera_graph.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "calibration/cameras/board.hpp"
#include "calibration/cameras/eigen_space.hpp"
#include "calibration/cameras/median.hpp"
#include "calibration/space_algebra.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr std::size_t kLeastSharedViews = 3;  // one view of a flat target leaves its tilt to the noise

/// The rotation nearest to the sum of the given ones, and the mean of the translations.
CameraPose mean_of(std::span<const CameraPose> poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  CameraPose mean;
  for (const auto& pose : poses) {
    sum += matrix_of(pose.rotation);
    mean.translation_mm = mean.translation_mm + (1.0 / static_cast<double>(poses.size())) * pose.translation_mm;
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  mean.rotation = matrix3_of(svd.matrixU() * svd.matrixV().transpose());
  return mean;
}

/// A view of both cameras of a pair.
struct Shared {
  std::size_t view = 0, points = 0;
  const BoardView* second = nullptr;  // what the second camera saw
  CameraPose first_pose, second_pose;
};

const BoardView* image_of(const BoardSet& set, std::size_t camera, std::size_t view) {
  const auto at = std::find_if(set.images.begin(), set.images.end(),
                               [&](const BoardView& i) { return i.camera == camera && i.view == view; });
  return at == set.images.end() ? nullptr : &*at;
}

std::size_t common_points(const BoardView& a, const BoardView& b) {
  std::vector<SeenPoint> both;
  std::set_intersection(a.seen.begin(), a.seen.end(), b.seen.begin(), b.seen.end(), std::back_inserter(both),
                        [](const SeenPoint& x, const SeenPoint& y) { return x.point < y.point; });
  return both.size();
}

std::vector<Shared> shared_views(const BoardSet& set, std::span<const SingleCamera> cameras, std::size_t a,
                                 std::size_t b) {
  std::vector<Shared> shared;
  for (std::size_t v = 0; v < set.views.size(); ++v) {
    const auto &pose_a = cameras[a].target[v], &pose_b = cameras[b].target[v];
    const BoardView *image_a = image_of(set, a, v), *image_b = image_of(set, b, v);
    if (pose_a && pose_b && image_a != nullptr && image_b != nullptr)
      shared.push_back({v, common_points(*image_a, *image_b), image_b, *pose_a, *pose_b});
  }
  return shared;
}

/// How far the second camera sees the target from where the first one's pose of it and `pose` put it.
double transfer_px(const BoardSet& set, const CameraIntrinsics& second, const Shared& s, const CameraPose& pose) {
  return rms_px(second, after(pose, s.first_pose), set.target_mm, s.second->seen);
}

CameraPair pair_of(const BoardSet& set, std::span<const SingleCamera> cameras, std::size_t a, std::size_t b,
                   double agree_px) {
  CameraPair pair{a, b, {}, 0, 0, std::numeric_limits<double>::infinity(), {}};
  const std::vector<Shared> shared = shared_views(set, cameras, a, b);
  const auto errors_of = [&](const CameraPose& pose) {
    std::vector<double> errors;
    for (const auto& s : shared) errors.push_back(transfer_px(set, cameras[b].lens, s, pose));
    return errors;
  };
  for (const auto& s : shared) {  // the view whose pose the others like best
    const CameraPose pose = after(s.second_pose, inverse(s.first_pose));
    if (const double error = median(errors_of(pose)); error < pair.transfer_px)
      pair.transfer_px = error, pair.second_from_first = pose;
  }
  const std::vector<double> errors = errors_of(pair.second_from_first);
  std::vector<CameraPose> agreeing;
  for (std::size_t i = 0; i < shared.size(); ++i) {
    if (errors[i] > agree_px) {
      pair.contradicting.push_back(shared[i].view);
      continue;
    }
    agreeing.push_back(after(shared[i].second_pose, inverse(shared[i].first_pose)));
    ++pair.views, pair.points += shared[i].points;
  }
  if (agreeing.empty()) return pair;
  pair.second_from_first = mean_of(agreeing);
  pair.transfer_px = median(errors_of(pair.second_from_first));
  return pair;
}

}  // namespace

std::optional<double> transfer_px(const BoardSet& set, std::span<const SingleCamera> cameras, const CameraPair& pair,
                                  std::size_t view) {
  const auto &first = cameras[pair.first].target[view], &second = cameras[pair.second].target[view];
  const BoardView* image = image_of(set, pair.second, view);
  if (!first || !second || image == nullptr) return std::nullopt;
  return rms_px(cameras[pair.second].lens, after(pair.second_from_first, *first), set.target_mm, image->seen);
}

CameraPose after(const CameraPose& a, const CameraPose& b) {
  return {a.rotation * b.rotation, a.rotation * b.translation_mm + a.translation_mm};
}

CameraPose inverse(const CameraPose& pose) {
  const Matrix3 back = transpose(pose.rotation);
  return {back, -1.0 * (back * pose.translation_mm)};
}

double angle_deg(const Matrix3& r) {
  const Point3 sine{r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]};
  return std::atan2(norm(sine), r[0][0] + r[1][1] + r[2][2] - 1) * 180 / std::numbers::pi;
}

double CameraPair::error_px() const noexcept {
  return transfer_px / std::sqrt(static_cast<double>(std::max<std::size_t>(views, 1)));
}

std::size_t CameraGraph::degree(std::size_t camera) const noexcept {
  return static_cast<std::size_t>(std::count_if(
      pairs.begin(), pairs.end(), [&](const CameraPair& p) { return p.first == camera || p.second == camera; }));
}

CameraGraph link_cameras(const BoardSet& set, std::span<const SingleCamera> cameras, double agree_px) {
  CameraGraph graph{cameras.size(), agree_px, is_flat(set.target_mm) ? kLeastSharedViews : 1, {}};
  for (std::size_t a = 0; a < cameras.size(); ++a)
    for (std::size_t b = a + 1; b < cameras.size(); ++b)
      if (CameraPair pair = pair_of(set, cameras, a, b, agree_px);
          pair.views + pair.contradicting.size() >= graph.least_views)
        graph.pairs.push_back(std::move(pair));
  return graph;
}

std::vector<CameraPose> register_cameras(const BoardSet& set, const CameraGraph& graph) {
  std::vector<CameraPose> poses(graph.cameras);
  std::vector<bool> reached(graph.cameras, false);
  reached[0] = true;
  for (std::size_t step = 1; step < graph.cameras; ++step) {
    const CameraPair* best = nullptr;
    for (const auto& pair : graph.pairs)
      if (reached[pair.first] != reached[pair.second] && (best == nullptr || pair.error_px() < best->error_px()))
        best = &pair;
    if (best == nullptr) {
      const auto lost = static_cast<std::size_t>(std::find(reached.begin(), reached.end(), false) - reached.begin());
      throw Error(
          ExitCode::bad_data,
          fmt::format(
              "camera {}: no chain of shared views leads from it to {}; take views that cameras of both groups see",
              set.cameras[lost].name, set.cameras[0].name));
    }
    if (reached[best->first])
      poses[best->second] = after(best->second_from_first, poses[best->first]);
    else
      poses[best->first] = after(inverse(best->second_from_first), poses[best->second]);
    reached[best->first] = reached[best->second] = true;
  }
  return poses;
}

}  // namespace rptv
