// SPDX-License-Identifier: MIT
// Harmonic fits per track, with the error of depth in them.
#include "simulation/track_swings.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.hpp"
#include "simulation/flow.hpp"
#include "simulation/track_time.hpp"

namespace rptv {

namespace {

struct Sample {
  double t_s, x_mm, y_mm, z_mm;
};
using Trajectories = std::map<std::uint64_t, std::vector<Sample>>;

Trajectories trajectories_of(const std::vector<TrackRow>& rows, const WallProfileSettings& settings) {
  Trajectories tracks;
  for (const auto& row : rows)
    tracks[row.particle].push_back({time_of(row, settings.rate_hz) - settings.start_s, row.x_mm, row.y_mm, row.z_mm});
  return tracks;
}

/// What depth does beyond a + b (t - mean), in units of its rms; empty when it does no more than rounding. The fluid
/// swings along x, so this is error.
Eigen::VectorXd depth_errors(const std::vector<Sample>& samples, double mean_t) {
  constexpr double kRounding_mm = 1e-8;
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixX2d basis(count, 2);
  Eigen::VectorXd depth(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sample& sample = samples[static_cast<std::size_t>(i)];
    basis.row(i) << 1.0, sample.t_s - mean_t;
    depth[i] = sample.z_mm;
  }
  depth -= basis * basis.colPivHouseholderQr().solve(depth);
  const double rms = depth.norm() / std::sqrt(static_cast<double>(count));
  return rms > kRounding_mm ? Eigen::VectorXd(depth / rms) : Eigen::VectorXd();
}

/// x = a + b (t - mean) + c sin(w t) + d cos(w t) + e (depth's error), least squares; false when the samples cannot
/// tell the terms apart.
bool fit_swing(const std::vector<Sample>& samples, const FlowSettings& flow, Swing& swing) {
  const double w = OscillatingWallFlow(flow).omega_rad_s();
  double mean_t = 0;
  swing = {};
  for (const auto& sample : samples) {
    mean_t += sample.t_s / static_cast<double>(samples.size());
    swing.height_mm += (sample.y_mm - flow.wall_y_mm) / static_cast<double>(samples.size());
  }
  const Eigen::VectorXd depth = depth_errors(samples, mean_t);
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd basis(count, depth.size() > 0 ? 5 : 4);
  Eigen::VectorXd x(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Sample& sample = samples[static_cast<std::size_t>(i)];
    basis.row(i).head(4) << 1.0, sample.t_s - mean_t, std::sin(w * sample.t_s), std::cos(w * sample.t_s);
    x[i] = sample.x_mm;
  }
  if (depth.size() > 0) basis.col(4) = depth;
  const Eigen::FullPivLU<Eigen::MatrixXd> solver(basis.transpose() * basis);
  if (!solver.isInvertible() || solver.rcond() < 1e-10) return false;
  const Eigen::VectorXd found = solver.solve(basis.transpose() * x);
  const Eigen::MatrixXd covariance = solver.inverse();
  swing.square_sum = (x - basis * found).squaredNorm();
  swing.value = {found[2], found[3]};
  swing.weight = 2.0 / (covariance(2, 2) + covariance(3, 3));
  swing.points = samples.size(), swing.terms = static_cast<std::uint64_t>(basis.cols());
  return true;
}

/// By each track's own noise, or the typical one where that is greater: two particles that overlapped for a while, or a
/// link that went astray, leave a track whose errors are ten times the others', and which must not count like them.
void weigh_by_noise(std::vector<Swing>& swings) {
  constexpr double kLeast_mm2 = 1e-18;  // of tracks without any noise
  const auto variance_of = [](const Swing& swing) {
    return swing.square_sum / static_cast<double>(swing.points - swing.terms);
  };
  std::vector<double> variances;
  for (const auto& swing : swings) variances.push_back(variance_of(swing));
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  for (auto& swing : swings) swing.weight /= std::max({variance_of(swing), *middle, kLeast_mm2});
}

}  // namespace

std::vector<Swing> swings_of(const std::vector<TrackRow>& rows, const FlowSettings& flow,
                             const WallProfileSettings& settings) {
  std::vector<Swing> swings;
  for (const auto& [particle, samples] : trajectories_of(rows, settings)) {
    const auto [first, last] =
        std::minmax_element(samples.begin(), samples.end(), [](auto& a, auto& b) { return a.t_s < b.t_s; });
    Swing swing;
    if (samples.size() >= 8 && last->t_s - first->t_s >= settings.min_periods / flow.frequency_hz &&
        fit_swing(samples, flow, swing))
      swings.push_back(swing);
  }
  if (swings.empty())
    throw Error(ExitCode::bad_data,
                fmt::format("no track spans {} period(s) of {} Hz: the profile needs longer tracks; "
                            "record longer or raise linker.search_range_mm or linker.memory",
                            settings.min_periods, flow.frequency_hz));
  weigh_by_noise(swings);
  return swings;
}

}  // namespace rptv
