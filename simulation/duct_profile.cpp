// SPDX-License-Identifier: MIT
// Velocities of steps, sorted by what the theory gives at their places.
#include "simulation/duct_profile.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "core/csv.hpp"
#include "core/error.hpp"
#include "simulation/duct_flow.hpp"
#include "simulation/track_time.hpp"

namespace rptv {

namespace {

constexpr std::size_t kBins = 10;
constexpr double kCentre = 0.8, kNearWalls = 0.4, kAtWalls = 0.07;  // shares of the largest velocity

struct Step {
  std::uint64_t particle;   // steps of one follow each other
  double measured, theory;  // mm/s
};

std::vector<Step> steps_of(const std::vector<TrackRow>& rows, const DuctFlow& duct, double rate_hz) {
  std::map<std::uint64_t, std::vector<const TrackRow*>> tracks;
  for (const auto& row : rows) tracks[row.particle].push_back(&row);
  std::vector<Step> steps;
  for (auto& [particle, points] : tracks) {
    std::sort(points.begin(), points.end(), [](const auto* a, const auto* b) { return a->frame < b->frame; });
    for (std::size_t i = 1; i < points.size(); ++i) {
      const TrackRow &from = *points[i - 1], &to = *points[i];
      const double dt_s = time_of(to, rate_hz) - time_of(from, rate_hz);
      const double theory = duct.velocity_mm_s((from.y_mm + to.y_mm) / 2, (from.z_mm + to.z_mm) / 2);
      if (dt_s > 0 && theory != 0) steps.push_back({particle, (to.x_mm - from.x_mm) / dt_s, theory});
    }
  }
  return steps;
}

/// Mean of |measured / theory − 1| over steps whose theory is in a range of shares of `largest`.
double deviation_of(const std::vector<Step>& steps, double largest, double from, double to) {
  double sum = 0, count = 0;
  for (const auto& step : steps) {
    const double share = step.theory / largest;
    if (share < from || share >= to) continue;
    sum += std::abs(step.measured / step.theory - 1), ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

/// The steps of one track, and the variance of their velocities about the theory's, scaled to the track.
struct TrackSteps {
  std::span<const Step> steps;
  double variance;
};

std::vector<TrackSteps> by_track(const std::vector<Step>& steps) {
  std::vector<TrackSteps> tracks;
  for (auto first = steps.begin(); first != steps.end();) {
    const auto last = std::find_if(first, steps.end(), [&](const Step& s) { return s.particle != first->particle; });
    double along = 0, square = 0, left = 0;
    for (auto s = first; s != last; ++s) along += s->measured * s->theory, square += s->theory * s->theory;
    for (auto s = first; s != last; ++s) left += std::pow(s->measured - along / square * s->theory, 2);
    tracks.push_back({{first, last}, left / std::max(static_cast<double>(last - first) - 1, 1.0)});
    first = last;
  }
  return tracks;
}

/// Weights by each track's own noise, or the typical one where that is greater: a link that went astray must not count
/// like the others. Successive steps of a track share a point, whose error moves them apart: for the standard error,
/// only what whole tracks pull is independent.
void fit_flow_rate(const std::vector<Step>& steps, DuctProfile& profile) {
  constexpr double kLeast = 1e-18;  // (mm/s)², of tracks without any noise
  const std::vector<TrackSteps> tracks = by_track(steps);
  std::vector<double> variances;
  for (const auto& track : tracks) variances.push_back(track.variance);
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  const auto weight_of = [&](const TrackSteps& track) { return 1 / std::max({track.variance, *middle, kLeast}); };
  double along = 0, square = 0, variance = 0;
  for (const auto& track : tracks)
    for (const auto& step : track.steps)
      along += weight_of(track) * step.measured * step.theory, square += weight_of(track) * step.theory * step.theory;
  const double scale = along / square;
  for (const auto& track : tracks) {
    double pull = 0;
    for (const auto& step : track.steps) pull += (step.measured - scale * step.theory) * step.theory;
    variance += std::pow(weight_of(track) * pull, 2);
  }
  profile.flow_rate_ul_min = profile.theory.flow_rate_ul_min * scale;
  profile.flow_rate_sigma_ul_min = std::abs(profile.theory.flow_rate_ul_min) * std::sqrt(variance) / square;
}

}  // namespace

DuctProfile measure_duct_profile(const std::vector<TrackRow>& tracks, const DuctSettings& theory, double rate_hz) {
  const DuctFlow duct(theory);
  const double largest = duct.velocity_mm_s(0, 0);
  const std::vector<Step> steps = steps_of(tracks, duct, rate_hz);
  if (steps.empty())
    throw Error(ExitCode::bad_data,
                "no track has two points inside the duct; compare duct.width_mm and height_mm with the positions");
  DuctProfile profile;
  profile.theory = theory;
  profile.steps = steps.size();
  fit_flow_rate(steps, profile);
  constexpr double kAll = std::numeric_limits<double>::infinity();
  profile.centre_deviation = deviation_of(steps, largest, kCentre, kAll);
  profile.wall_deviation = deviation_of(steps, largest, kAtWalls, kNearWalls);
  std::array<DuctProfileBin, kBins> bins{};
  for (const auto& step : steps) {
    auto& bin = bins[std::min(static_cast<std::size_t>(kBins * step.theory / largest), kBins - 1)];
    bin.velocity_mm_s += step.measured, bin.theory_mm_s += step.theory;
    bin.deviation += std::abs(step.measured / step.theory - 1);
    ++bin.steps;
  }
  for (auto& bin : bins) {
    if (bin.steps == 0) continue;
    const auto n = static_cast<double>(bin.steps);
    profile.bins.push_back({bin.velocity_mm_s / n, bin.theory_mm_s / n, bin.deviation / n, bin.steps});
  }
  return profile;
}

void write_duct_profile(const DuctProfile& profile, const std::filesystem::path& file) {
  CsvWriter csv(file, "velocity_mm_s,theory_mm_s,deviation,steps");
  for (const auto& bin : profile.bins)
    csv.number(bin.velocity_mm_s).number(bin.theory_mm_s).number(bin.deviation).index(bin.steps).end_row();
  csv.close();
}

}  // namespace rptv
