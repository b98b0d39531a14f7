// SPDX-License-Identifier: MIT
// A bundle adjustment whose points are the parts of the volume.
#include "calibration/cameras/self_calibration.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "core/quote.hpp"

namespace rptv {
namespace {

constexpr double kFloor_px = 0.02;  // a peak is hardly better than this, whatever its votes
constexpr double kLoss = 3;         // standard errors of a peak; beyond, residuals count linearly (Huber 1964)
constexpr double kStay_px = 0.05;   // changes of a camera beyond this count linearly: few large ones, not many small
constexpr double kStep = 1e-3;      // of central differences, in about pixels

/// Cameras as Ceres turns them, and their neighbours for central differences.
struct TurnedCameras : ceres::EvaluationCallback {
  std::vector<CameraChange> changes;
  std::vector<std::vector<double>> by;           // parameter blocks
  std::vector<std::vector<CameraModel>> models;  // of each camera: as it is, then one step on and one back per number

  void PrepareForEvaluation(bool, bool new_point) override {
    if (!new_point) return;
    for (std::size_t c = 0; c < changes.size(); ++c) {
      models[c].clear();
      try {
        models[c].push_back(changes[c].changed(by[c]));
        for (std::size_t k = 0; k < by[c].size(); ++k)
          for (const double step : {kStep, -kStep}) {
            std::vector<double> near = by[c];
            near[k] += step;
            models[c].push_back(changes[c].changed(near));
          }
      } catch (const Error&) {
        models[c].clear();  // a step too far: the camera behind the glass
      }
    }
  }
};

/// Where a camera should see the mean particle of a part.
struct PartSighting {
  std::size_t camera = 0, point = 0;
  Pixel pixel{};
  double sigma_px = 0;
};

class PartCost : public ceres::CostFunction {
 public:
  PartCost(const TurnedCameras& cameras, const PartSighting& seen) : cameras_(cameras), seen_(seen) {
    set_num_residuals(2);
    *mutable_parameter_block_sizes() = {static_cast<int>(cameras.by[seen.camera].size()), 3};
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const auto& models = cameras_.models[seen_.camera];
    if (models.empty()) return false;
    const Point3 point{parameters[1][0], parameters[1][1], parameters[1][2]};
    PixelJacobian by_point;
    const auto at = models[0].project(point, by_point);
    if (!at) return false;
    for (std::size_t i = 0; i < 2; ++i) residuals[i] = ((*at)[i] - seen_.pixel[i]) / seen_.sigma_px;
    if (jacobians == nullptr) return true;
    if (jacobians[1] != nullptr)
      for (std::size_t i = 0; i < 6; ++i) jacobians[1][i] = by_point[i / 3][i % 3] / seen_.sigma_px;
    const std::size_t numbers = models.size() / 2;
    for (std::size_t k = 0; jacobians[0] != nullptr && k < numbers; ++k) {
      const auto on = models[1 + 2 * k].project(point), back = models[2 + 2 * k].project(point);
      if (!on || !back) return false;
      for (std::size_t i = 0; i < 2; ++i)
        jacobians[0][i * numbers + k] = ((*on)[i] - (*back)[i]) / (2 * kStep * seen_.sigma_px);
    }
    return true;
  }

 private:
  const TurnedCameras& cameras_;
  PartSighting seen_;
};

/// A camera's change, px. It chooses among rigs that serve alike and is too weak to keep a disparity.
class StayCost : public ceres::CostFunction {
 public:
  explicit StayCost(std::size_t numbers) {
    set_num_residuals(static_cast<int>(numbers));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(numbers));
  }

  bool Evaluate(const double* const* parameters, double* residuals, double** jacobians) const override {
    const auto numbers = static_cast<std::size_t>(num_residuals());
    std::copy_n(parameters[0], numbers, residuals);
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    std::fill_n(jacobians[0], numbers * numbers, 0);
    for (std::size_t k = 0; k < numbers; ++k) jacobians[0][k * (numbers + 1)] = 1;
    return true;
  }
};

/// Sightings in the parts that two or more cameras have a peak in, and these parts' mean particles.
std::vector<PartSighting> sightings_of(const Rig& rig, const DisparityMaps& maps, std::vector<Point3>& points) {
  std::vector<PartSighting> seen;
  for (std::size_t part = 0; part < maps.grid().size(); ++part) {
    const Point3 middle = maps.middle_mm(part);
    std::vector<PartSighting> here;
    for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
      const auto peak = maps.peak(c, part);
      const auto at = rig.cameras[c].model.project(middle);
      if (!peak || !at) continue;
      here.push_back({c,
                      points.size(),
                      {(*at)[0] - peak->at_px[0], (*at)[1] - peak->at_px[1]},
                      std::hypot(peak->sigma_px, kFloor_px)});
    }
    if (here.size() < 2) continue;
    points.push_back(middle);
    seen.insert(seen.end(), here.begin(), here.end());
  }
  return seen;
}

/// The first camera with fewer than kLeastParts sightings and how many it has; none: all have enough.
std::optional<std::pair<std::size_t, std::size_t>> blind_camera(const std::vector<PartSighting>& seen,
                                                                std::size_t cameras) {
  for (std::size_t c = 0; c < cameras; ++c) {
    const auto parts = std::count_if(seen.begin(), seen.end(), [&](const PartSighting& s) { return s.camera == c; });
    if (static_cast<std::size_t>(parts) < kLeastParts) return {{c, static_cast<std::size_t>(parts)}};
  }
  return {};
}

/// Of the first round: where chance drowns what is looked for far away, it is looked for nearer by.
DisparityMaps first_maps(const Rig& rig, const DisparityGrid& grid, double& search_px, double finest_px,
                         const GatherDisparities& gather) {
  for (;;) {
    DisparityMaps maps(grid, rig.cameras.size(), search_px);
    gather(rig, maps);
    std::vector<Point3> points;
    if (search_px <= finest_px || !blind_camera(sightings_of(rig, maps, points), rig.cameras.size())) return maps;
    search_px = std::max(0.6 * search_px, finest_px);
  }
}

void solve(TurnedCameras& cameras, std::vector<Point3>& points, const std::vector<PartSighting>& seen,
           const std::string& origin) {
  ceres::Problem::Options with;
  with.evaluation_callback = &cameras;
  ceres::Problem problem(with);
  ceres::Solver::Options options;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (const auto& s : seen)
    problem.AddResidualBlock(new PartCost(cameras, s), new ceres::HuberLoss(kLoss), cameras.by[s.camera].data(),
                             points[s.point].data());
  for (auto& by : cameras.by) {
    problem.AddResidualBlock(new StayCost(by.size()), new ceres::HuberLoss(kStay_px), by.data());
    options.linear_solver_ordering->AddElementToGroup(by.data(), 1);
  }
  for (auto& point : points) options.linear_solver_ordering->AddElementToGroup(point.data(), 0);
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-10, options.parameter_tolerance = 1e-10;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  if (!summary.IsSolutionUsable())
    throw Error(ExitCode::bad_data, fmt::format("{}: the cameras cannot be corrected by these disparities ({}); "
                                                "calibrate them with a target, or give more images",
                                                origin, summary.message));
}

double worst_median_px(const std::vector<CameraDisparity>& cameras) {
  double worst = 0;
  for (const auto& camera : cameras) worst = std::max(worst, camera.median_px);
  return worst;
}

}  // namespace

Rig corrected_rig(const Rig& rig, const Rig& start, const DisparityMaps& maps, CameraFreedom freedom,
                  const std::string& origin) {
  std::vector<Point3> points;
  const auto seen = sightings_of(rig, maps, points);
  if (const auto blind = blind_camera(seen, rig.cameras.size()))
    throw Error(ExitCode::bad_data,
                fmt::format("{}: camera {} has a clear disparity within {:.3g} px in {} of {} parts of the volume and "
                            "needs {}; give more images, search farther, or cut the volume into fewer parts",
                            origin, in_quotes(rig.cameras[blind->first].name), maps.radius_px(), blind->second,
                            maps.grid().size(), kLeastParts));
  const Point3 middle = 0.5 * (maps.grid().from_mm + maps.grid().to_mm);
  TurnedCameras cameras;
  for (const RigCamera& camera : start.cameras) {
    cameras.changes.emplace_back(freedom, camera.model, norm(middle - camera.model.centre_mm()));
    cameras.by.emplace_back(cameras.changes.back().size());
  }
  cameras.models.resize(rig.cameras.size());
  solve(cameras, points, seen, origin);
  Rig better;
  for (std::size_t c = 0; c < rig.cameras.size(); ++c)
    better.cameras.push_back({rig.cameras[c].name, cameras.changes[c].changed(cameras.by[c])});
  return better;
}

SelfCalibration self_calibrate(const Rig& start, const DisparityGrid& grid, const SelfCalibrationOptions& options,
                               const GatherDisparities& gather, const std::string& origin) {
  SelfCalibration result{start, {}, {}};
  double search_px = std::max(options.search_px, options.finest_px);
  for (std::size_t round = 0; round <= options.rounds; ++round) {
    DisparityMaps maps = round == 0 ? first_maps(start, grid, search_px, options.finest_px, gather)
                                    : DisparityMaps(grid, start.cameras.size(), search_px);
    if (round > 0) gather(result.rig, maps);
    auto& summaries = round == 0 ? result.before : result.after;
    summaries.clear();
    for (std::size_t c = 0; c < start.cameras.size(); ++c) summaries.push_back(maps.summary(c));
    if (round == options.rounds) break;
    result.rig = corrected_rig(result.rig, start, maps, options.freedom, origin);
    search_px = std::max(search_px / 3, options.finest_px);
  }
  const double before_px = worst_median_px(result.before), after_px = worst_median_px(result.after);
  if (!(after_px < before_px))
    throw Error(ExitCode::bad_data,
                fmt::format("{}: the worst camera's median disparity was {:.3g} px and would be {:.3g} px; keep this "
                            "rig, or let more of the lens be fitted",
                            origin, before_px, after_px));
  return result;
}

}  // namespace rptv
