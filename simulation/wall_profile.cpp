// SPDX-License-Identifier: MIT
// Layers of fluid, and the Stokes layer that fits them all.
#include "simulation/wall_profile.hpp"

#include <cmath>
#include <complex>

#include "core/csv.hpp"
#include "simulation/track_swings.hpp"

namespace rptv {

namespace {

using Complex = std::complex<double>;

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
  const auto swings = swings_of(tracks, theory, settings);
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
