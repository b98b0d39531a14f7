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

/// A parameter block and where it is in the covariance.
struct Block {
  const double* values = nullptr;
  std::size_t size = 0, place = 0;
};

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

  /// Covariance of `blocks` (address, size, place in the matrix) for residuals of standard error `sigma_px`, size x
  /// size; empty when they are not determined.
  std::vector<double> covariance_of(const std::vector<Block>& blocks, std::size_t size, double sigma_px) {
    std::vector<const double*> wanted;
    std::vector<std::size_t> place;
    for (const auto& block : blocks)
      if (problem_.HasParameterBlock(block.values)) {
        wanted.push_back(block.values);
        for (std::size_t k = 0; k < block.size; ++k) place.push_back(block.place + k);
      }
    ceres::Covariance::Options options;
    options.apply_loss_function = false;
    options.num_threads = 2;
    ceres::Covariance covariance(options);
    std::vector<double> dense(place.size() * place.size());
    if (!covariance.Compute(wanted, &problem_) || !covariance.GetCovarianceMatrix(wanted, dense.data())) return {};
    std::vector<double> all(size * size, 0);
    for (std::size_t i = 0; i < place.size(); ++i)
      for (std::size_t j = 0; j < place.size(); ++j)
        all[place[i] * size + place[j]] = sigma_px * sigma_px * dense[i * place.size() + j];
    return all;
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

/// The parameters as they are and their covariance.
BundleCovariance covariance_of(const Parameters& p, BundleProblem& problem, const BundleOptions& options,
                               double sigma_px) {
  BundleCovariance c{p.lenses, p.cameras, p.stack, {}, {}, p.distortions, {}};
  c.walls.stack = p.base->stack, c.walls.windows = p.base->windows;
  std::vector<Block> blocks;
  for (std::size_t k = 0; k < p.lenses.size(); ++k) {
    blocks.push_back({p.lenses[k].data(), p.lenses[k].size(), 9 * k});
    blocks.push_back({p.cameras[k].data(), p.cameras[k].size(), c.pose_at(k)});
  }
  if (options.fit_stack) blocks.push_back({p.stack.data(), p.stack.size(), c.stack_at()});
  if (options.frame_view) {
    const PoseParameters& frame = p.targets[*options.frame_view];
    c.frame = frame;
    blocks.push_back({frame.data(), frame.size(), c.frame_at()});
  }
  c.values = problem.covariance_of(blocks, c.size(), sigma_px);
  return c;
}

/// Standard errors of each camera's `size` parameters, which are at `first` for the first one.
std::vector<std::vector<double>> errors_in(const BundleCovariance& c, std::size_t first, std::size_t size) {
  std::vector<std::vector<double>> errors;
  for (std::size_t k = 0; !c.values.empty() && k < c.cameras.size(); ++k) {
    auto& error = errors.emplace_back(size);
    for (std::size_t i = 0; i < size; ++i)
      error[i] = std::sqrt(std::max(c.values[(first + k * size + i) * (c.size() + 1)], 0.0));
  }
  return errors;
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
  BundleResult result{start, residuals_of(set, start, p), 0, 0, 0, {}, {}, {}, 0};
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
  result.covariance = covariance_of(p, last, options, result.sigma_px);
  result.lens_sigma = errors_in(result.covariance, 0, std::tuple_size_v<LensParameters>);
  result.camera_sigma = errors_in(result.covariance, result.covariance.pose_at(0), std::tuple_size_v<PoseParameters>);
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
