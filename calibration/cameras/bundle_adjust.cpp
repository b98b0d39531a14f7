// SPDX-License-Identifier: MIT
// The bundle as a problem for Ceres; with its residuals, the only source that includes it.
#include "calibration/cameras/bundle_adjust.hpp"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calibration/cameras/bundle_costs.hpp"
#include "calibration/cameras/median.hpp"
#include "core/error.hpp"

namespace rptv {

namespace {

constexpr double kWideLoss_px = 1;
constexpr double kOutlier = 5;             // standard errors
constexpr double kMedianToSigma = 1.1774;  // of the distance of two normal coordinates

/// Parameter blocks, at addresses that stay, and what Ceres has to renew whenever it has moved them.
struct Parameters : ceres::EvaluationCallback {
  std::vector<LensParameters> lenses;
  std::vector<PoseParameters> cameras, targets;
  StackParameters stack{}, held{};           // of the common wall, and of windows of cameras
  const Bundle* base = nullptr;              // has the walls that these move
  std::vector<BrownDistortion> distortions;  // of the lenses

  void PrepareForEvaluation(bool, bool new_point) override {
    if (new_point) std::transform(lenses.begin(), lenses.end(), distortions.begin(), distortion_of);
  }
};

BundleProjection projection_of(const Parameters& p, std::size_t camera, std::size_t view) {
  const bool own = p.base->has_window(camera);
  return {p.lenses[camera],
          p.cameras[camera],
          p.targets[view],
          own ? &p.base->windows[camera] : &p.base->stack,
          own ? p.held : p.stack,
          &p.distortions[camera],
          own};
}

/// Residuals of every seen point of the views in use. Points that are not projected are left out; Ceres refuses them.
std::vector<PointResidual> residuals_of(const BoardSet& set, const Bundle& bundle, Parameters& p) {
  p.PrepareForEvaluation(false, true);
  std::vector<PointResidual> residuals;
  for (std::size_t i = 0; i < set.images.size(); ++i) {
    const BoardView& image = set.images[i];
    if (!bundle.targets[image.view]) continue;
    const BundleProjection projection = projection_of(p, image.camera, image.view);
    for (const auto& s : image.seen)
      if (Pixel at; projection.project(set.target_mm[s.point], at, nullptr))
        residuals.push_back({i, s, {s.pixel[0] - at[0], s.pixel[1] - at[1]}});
  }
  return residuals;
}

double distance(const PointResidual& r) { return std::hypot(r.error_px[0], r.error_px[1]); }

class BundleProblem {
 public:
  BundleProblem(const BoardSet& set, Parameters& p, const BundleOptions& options,
                const std::vector<PointResidual>& seen, double loss_px)
      : problem_(options_with(p)) {
    for (const auto& r : seen) {
      const BoardView& image = set.images[r.image];
      const bool own = p.base->has_window(image.camera);
      StackParameters& wall = own ? p.held : p.stack;
      problem_.AddResidualBlock(
          new SeenPointCost(set.target_mm[r.seen.point], r.seen.pixel, projection_of(p, image.camera, image.view)),
          new ceres::HuberLoss(loss_px), p.lenses[image.camera].data(), p.cameras[image.camera].data(),
          p.targets[image.view].data(), wall.data());
      if (own || !options.fit_stack) problem_.SetParameterBlockConstant(wall.data());
    }
    for (auto& lens : p.lenses) {
      if (!problem_.HasParameterBlock(lens.data())) continue;
      if (!options.fit_lenses)
        problem_.SetParameterBlockConstant(lens.data());
      else if (!options.fit_k3)
        problem_.SetManifold(lens.data(), new ceres::SubsetManifold(9, {8}));
    }
    for (const auto& rod : options.rods)
      problem_.AddResidualBlock(new RodCost(rod.length_mm), nullptr, p.targets[rod.first].data(),
                                p.targets[rod.second].data());
    for (auto& target : p.targets)
      if (options.single_points && problem_.HasParameterBlock(target.data()))
        problem_.SetManifold(target.data(), new ceres::SubsetManifold(6, {0, 1, 2}));
    if (problem_.HasParameterBlock(p.cameras[0].data())) problem_.SetParameterBlockConstant(p.cameras[0].data());
  }

  int solve() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-12, options.gradient_tolerance = 1e-14, options.parameter_tolerance = 1e-12;
    options.logging_type = ceres::SILENT;
    options.num_threads = 2;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem_, &summary);
    if (!summary.IsSolutionUsable() || summary.termination_type == ceres::NO_CONVERGENCE)
      throw Error(ExitCode::bad_data,
                  fmt::format("the bundle adjustment does not converge ({}); take more views that several cameras see, "
                              "with the target tilted to all sides",
                              summary.message));
    return static_cast<int>(summary.iterations.size());
  }

  /// Standard errors of `blocks`, for residuals of standard error `sigma_px`; empty when they are not determined.
  std::vector<std::vector<double>> errors_of(const std::vector<std::pair<const double*, std::size_t>>& blocks,
                                             double sigma_px) {
    std::vector<std::pair<const double*, const double*>> wanted;
    for (const auto& [block, size] : blocks)
      if (problem_.HasParameterBlock(block)) wanted.emplace_back(block, block);
    ceres::Covariance::Options options;
    options.apply_loss_function = false;
    ceres::Covariance covariance(options);
    if (!covariance.Compute(wanted, &problem_)) return {};
    std::vector<std::vector<double>> errors;
    for (const auto& [block, size] : blocks) {
      std::vector<double> square(size * size, 0), error(size);
      if (problem_.HasParameterBlock(block) && !covariance.GetCovarianceBlock(block, block, square.data())) return {};
      for (std::size_t k = 0; k < size; ++k) error[k] = sigma_px * std::sqrt(std::max(square[k * size + k], 0.0));
      errors.push_back(std::move(error));
    }
    return errors;
  }

 private:
  static ceres::Problem::Options options_with(Parameters& p) {
    ceres::Problem::Options options;
    options.evaluation_callback = &p;
    return options;
  }
  ceres::Problem problem_;
};

/// Robust standard error of a coordinate.
double sigma_of(const std::vector<PointResidual>& residuals, double freedom) {
  std::vector<double> distances;
  for (const auto& r : residuals) distances.push_back(distance(r));
  return median(distances) / kMedianToSigma / std::sqrt(freedom);
}

}  // namespace

BundleResult adjust_bundle(const BoardSet& set, const Bundle& start, const BundleOptions& options) {
  Parameters p;
  p.base = &start;
  std::size_t unknowns = 6 * (start.cameras.size() - 1) + (options.fit_stack ? 3 : 0);
  for (const auto& lens : start.lenses) p.lenses.push_back(parameters_of(lens)), unknowns += options.fit_lenses ? 8 : 0;
  for (const auto& pose : start.cameras) p.cameras.push_back(parameters_of(pose));
  for (const auto& target : start.targets) {
    p.targets.push_back(parameters_of(target.value_or(CameraPose{})));
    unknowns += !target ? 0 : options.single_points ? 3 : 6;
  }
  p.distortions.resize(p.lenses.size());
  BundleResult result{start, residuals_of(set, start, p), 0, 0, 0, {}, {}, 0};
  const double values = static_cast<double>(2 * result.residuals.size() + options.rods.size());
  if (!(values > static_cast<double>(unknowns)))
    throw Error(ExitCode::bad_data,
                fmt::format("{} coordinates cannot tell {} unknowns; take more views", values, unknowns));
  const double freedom = 1 - static_cast<double>(unknowns) / values;
  const auto seen = result.residuals;
  result.iterations = BundleProblem(set, p, options, seen, kWideLoss_px).solve();
  const double found_px = sigma_of(residuals_of(set, start, p), freedom);
  BundleProblem last(set, p, options, seen, std::max(options.length_factor * found_px, 1e-6));
  result.iterations += last.solve();

  result.residuals = residuals_of(set, start, p);
  result.sigma_px = sigma_of(result.residuals, freedom);
  double sum = 0;
  for (const auto& r : result.residuals) {
    sum += distance(r) * distance(r);
    if (distance(r) > kOutlier * result.sigma_px) ++result.outliers;
  }
  result.rms_px = std::sqrt(sum / static_cast<double>(result.residuals.size()));
  std::vector<std::pair<const double*, std::size_t>> lenses, cameras;
  for (const auto& block : p.lenses) lenses.emplace_back(block.data(), block.size());
  for (const auto& block : p.cameras) cameras.emplace_back(block.data(), block.size());
  result.lens_sigma = last.errors_of(lenses, result.sigma_px);
  result.camera_sigma = last.errors_of(cameras, result.sigma_px);
  for (std::size_t c = 0; c < p.cameras.size(); ++c) {
    result.bundle.lenses[c] = lens_of(p.lenses[c], start.lenses[c]);
    if (c > 0) result.bundle.cameras[c] = pose_of(p.cameras[c]);
  }
  for (std::size_t v = 0; v < p.targets.size(); ++v)
    if (start.targets[v]) result.bundle.targets[v] = pose_of(p.targets[v]);
  if (options.fit_stack) result.bundle.stack = moved(start.stack, p.stack);
  return result;
}

}  // namespace rptv
