// SPDX-License-Identifier: MIT
// Harmonic fits per track, layers of fluid, and the Stokes layer that fits them all.
#include "simulation/wall_profile.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <map>

#include "core/csv.hpp"
#include "core/error.hpp"
#include "simulation/flow.hpp"
#include "simulation/track_time.hpp"

namespace rptv {

namespace {

using Complex = std::complex<double>;

/// The swing of one track: amplitude·exp(i phase) of sin, at its mean height above the wall.
struct Swing {
  double height_mm = 0;
  Complex value;
  double weight = 0;  ///< inverse variance of one component, 1/mm²; first for unit noise
  double square_sum = 0;
  std::uint64_t points = 0, terms = 0;
};

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
  return swings;
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

Complex stokes(double height_mm, double layer_mm) { return std::exp(Complex(-1.0, -1.0) * (height_mm / layer_mm)); }

/// One layer's weighted mean beside the theory's, over the same tracks.
WallProfileBin bin_of(const std::vector<const Swing*>& swings, const FlowSettings& flow) {
  WallProfileBin bin;
  Complex sum, theory;
  double weight = 0;
  for (const auto* swing : swings) {
    sum += swing->weight * swing->value;
    theory += swing->weight * flow.wall_amplitude_mm * stokes(swing->height_mm, flow.stokes_layer_mm);
    bin.height_mm += swing->weight * swing->height_mm;
    weight += swing->weight;
    bin.points += swing->points;
  }
  bin.tracks = swings.size();
  bin.height_mm /= weight;
  bin.amplitude_mm = std::abs(sum) / weight;
  bin.amplitude_sigma_mm = 1 / std::sqrt(weight);
  bin.theory_amplitude_mm = std::abs(theory) / weight;
  const double layer_phase = -bin.height_mm / flow.stokes_layer_mm;  // unwraps both
  bin.theory_phase_rad = layer_phase + std::arg(theory * std::polar(1.0, -layer_phase));
  bin.phase_rad = bin.theory_phase_rad + std::arg(sum * std::conj(theory));
  return bin;
}

/// From the top down: little is left of the wall's swing there, and noise turns its phase.
void join_unsure(std::vector<std::vector<const Swing*>>& members, const FlowSettings& flow, double most_sigma_rad) {
  for (std::size_t layer = members.size(); layer-- > 1;) {
    auto &here = members[layer], &below = members[layer - 1];
    if (here.empty()) continue;
    const WallProfileBin bin = bin_of(here, flow);
    if (bin.amplitude_sigma_mm <= most_sigma_rad * bin.theory_amplitude_mm) continue;
    below.insert(below.end(), here.begin(), here.end());
    here.clear();
  }
}

/// Best complex wall amplitude for a layer thickness, and the weighted misfit.
struct LayerFit {
  double layer_mm = 0, misfit = 0;
  Complex wall;
};

LayerFit fit_wall(const std::vector<Swing>& swings, double layer_mm) {
  LayerFit fit{layer_mm, 0, {}};
  Complex projection;
  double norm = 0;
  for (const auto& swing : swings) {
    const Complex shape = stokes(swing.height_mm, layer_mm);
    projection += swing.weight * std::conj(shape) * swing.value;
    norm += swing.weight * std::norm(shape);
  }
  if (norm > 0) fit.wall = projection / norm;
  for (const auto& swing : swings)
    fit.misfit += swing.weight * std::norm(swing.value - fit.wall * stokes(swing.height_mm, layer_mm));
  return fit;
}

/// Scan over 1/10 … 10 times the expected thickness, then golden section in the logarithm.
LayerFit fit_layer(const std::vector<Swing>& swings, double expected_mm) {
  constexpr int kSteps = 80;
  const double step = std::log(100.0) / kSteps;
  const auto at = [&](double log_layer) { return fit_wall(swings, expected_mm * std::exp(log_layer)); };
  double best = 0, misfit = at(0).misfit;
  for (int i = 0; i <= kSteps; ++i) {
    const double candidate = -0.5 * std::log(100.0) + step * i;
    if (const double value = at(candidate).misfit; value < misfit) {
      misfit = value;
      best = candidate;
    }
  }
  double low = best - step, high = best + step;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  while (high - low > 1e-9) {
    const double a = high - golden * (high - low), b = low + golden * (high - low);
    (at(a).misfit < at(b).misfit ? high : low) = at(a).misfit < at(b).misfit ? b : a;
  }
  return at(0.5 * (low + high));
}

void sum_up(WallProfile& profile) {
  double amplitude = 0, phase = 0, phase_bins = 0;
  for (const auto& bin : profile.bins) {
    amplitude += std::pow(bin.amplitude_mm - bin.theory_amplitude_mm, 2);
    if (bin.theory_amplitude_mm < 0.05 * profile.theory.wall_amplitude_mm) continue;
    phase += std::pow(bin.phase_rad - bin.theory_phase_rad, 2);
    ++phase_bins;
  }
  profile.amplitude_rms_mm = std::sqrt(amplitude / static_cast<double>(profile.bins.size()));
  if (profile.theory.wall_amplitude_mm > 0)
    profile.amplitude_rms_relative = profile.amplitude_rms_mm / profile.theory.wall_amplitude_mm;
  if (phase_bins > 0) profile.phase_rms_rad = std::sqrt(phase / phase_bins);
}

}  // namespace

WallProfile measure_wall_profile(const std::vector<TrackRow>& tracks, const FlowSettings& theory,
                                 const WallProfileSettings& settings) {
  auto swings = swings_of(tracks, theory, settings);
  weigh_by_noise(swings);
  WallProfile profile;
  profile.theory = theory;
  profile.tracks = swings.size();
  const auto bins = static_cast<std::size_t>(settings.bins);
  std::vector<std::vector<const Swing*>> members(bins);
  for (const auto& swing : swings) {
    const double position = swing.height_mm / settings.top_mm * static_cast<double>(bins);
    if (position < static_cast<double>(bins))
      members[static_cast<std::size_t>(std::max(0.0, position))].push_back(&swing);
  }
  if (settings.most_phase_sigma_deg > 0) join_unsure(members, theory, settings.most_phase_sigma_deg * M_PI / 180);
  for (const auto& layer : members)
    if (!layer.empty()) profile.bins.push_back(bin_of(layer, theory));
  const LayerFit fit = fit_layer(swings, theory.stokes_layer_mm);
  profile.wall_amplitude_mm = std::abs(fit.wall);
  profile.wall_phase_rad = std::arg(fit.wall);
  profile.stokes_layer_mm = fit.layer_mm;
  if (!profile.bins.empty()) sum_up(profile);
  return profile;
}

void write_wall_profile(const WallProfile& profile, const std::filesystem::path& file) {
  CsvWriter csv(
      file, "height_mm,amplitude_mm,phase_rad,amplitude_sigma_mm,theory_amplitude_mm,theory_phase_rad,tracks,points");
  for (const auto& bin : profile.bins) {
    for (const double value : {bin.height_mm, bin.amplitude_mm, bin.phase_rad, bin.amplitude_sigma_mm,
                               bin.theory_amplitude_mm, bin.theory_phase_rad})
      csv.number(value);
    csv.index(bin.tracks).index(bin.points).end_row();
  }
  csv.close();
}

}  // namespace rptv
