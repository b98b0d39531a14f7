// SPDX-License-Identifier: MIT
// From measured tracks to the amplitude and phase of the flow above an oscillating wall, beside Stokes' solution.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/tables.hpp"
#include "simulation/scenario.hpp"

namespace rptv {

struct WallProfileSettings {
  std::int64_t bins = 14;
  double top_mm = 7.0;              ///< bins reach from the wall to this height above it
  double min_periods = 1.0;         ///< shorter tracks are left out: mean, drift and swing cannot be told apart in them
  double most_phase_sigma_deg = 0;  ///< a layer whose phase is less sure is joined with the one below it; 0: none is
  double rate_hz = 0;               ///< time = frame / rate where the table has no t; 0: such tables are refused
  double start_s = 0;               ///< subtracted from t: the instant at which the wall's phase is 0
};

/// One layer of fluid. Displacement x = amplitude sin(w t + phase).
struct WallProfileBin {
  double height_mm = 0;  ///< mean distance from the wall, weighted like the amplitude
  double amplitude_mm = 0;
  double phase_rad = 0;            ///< unwrapped towards the theory
  double amplitude_sigma_mm = 0;   ///< standard error from the scatter of the fits' residuals
  double theory_amplitude_mm = 0;  ///< Stokes' solution averaged over the same tracks: no bias by the bin's width
  double theory_phase_rad = 0;
  std::uint64_t tracks = 0, points = 0;
};

struct WallProfile {
  std::vector<WallProfileBin> bins;   ///< those that have tracks, from the wall upwards
  double amplitude_rms_mm = 0;        ///< rms of amplitude minus theory over the bins
  double amplitude_rms_relative = 0;  ///< the same over the wall's amplitude
  double phase_rms_rad = 0;           ///< over bins whose theoretical amplitude is at least 5 % of the wall's
  double wall_amplitude_mm = 0;  ///< fitted to all tracks: A, delta and phase of A exp(-k e) sin(w t - k e + phase)
  double stokes_layer_mm = 0;
  double wall_phase_rad = 0;
  FlowSettings theory;
  std::uint64_t tracks = 0;  ///< used
};

/// Least squares of a + b t + c sin(w t) + d cos(w t) + e q to the x of each track (b: drift), then means of the
/// complex amplitude c + i d over bins of height, weighted by its information and the track's own noise. q is what
/// depth does beyond its drift: the wall and the fluid swing along x alone, so q is error of the depth, and an error of
/// depth moves x along the line of sight (regressions whose errors are correlated, Zellner 1962; for a wall that swings
/// in z also, turn the tracks first). Rows in any order. Throws Error(bad_data) when no track is long enough. Batch
/// use.
WallProfile measure_wall_profile(const std::vector<TrackRow>& tracks, const FlowSettings& theory,
                                 const WallProfileSettings& settings = {});

/// height_mm,amplitude_mm,phase_rad,amplitude_sigma_mm,theory_amplitude_mm,theory_phase_rad,tracks,points. Throws as
/// CsvWriter.
void write_wall_profile(const WallProfile& profile, const std::filesystem::path& file);

}  // namespace rptv
