// SPDX-License-Identifier: MIT
// From measured tracks to the flow rate and profile of a duct, beside the laminar solution.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/tables.hpp"
#include "simulation/flow_settings.hpp"

namespace rptv {

/// The part of the duct in which the theory gives a certain share of the largest velocity.
struct DuctProfileBin {
  double velocity_mm_s = 0;  ///< mean of the measured ones
  double theory_mm_s = 0;    ///< mean of the theory at the same places
  double deviation = 0;      ///< mean of |measured / theory − 1|
  std::uint64_t steps = 0;
};

struct DuctProfile {
  std::vector<DuctProfileBin> bins;   ///< those that have steps, from the walls to the middle
  double flow_rate_ul_min = 0;        ///< that scales the theory to the measured velocities, each track by its noise
  double flow_rate_sigma_ul_min = 0;  ///< standard error, from what is left over, track by track
  double centre_deviation = 0;  ///< mean of |measured / theory − 1| where the theory is at least 0.8 of its largest
  double wall_deviation = 0;    ///< the same where it is 0.07 to 0.4: near walls and in corners; NaN without any
  std::uint64_t steps = 0;
  DuctSettings theory;
};

/// Velocity along x between successive points of each track, at the middle between them; duct and tracks in object
/// space, the duct centred on the axis. Rows in any order; `rate_hz` as for wall profiles. Throws Error(bad_data) when
/// no track has two points inside the duct. Batch use.
DuctProfile measure_duct_profile(const std::vector<TrackRow>& tracks, const DuctSettings& theory, double rate_hz = 0);

/// velocity_mm_s,theory_mm_s,deviation,steps. Throws as CsvWriter.
void write_duct_profile(const DuctProfile& profile, const std::filesystem::path& file);

}  // namespace rptv
