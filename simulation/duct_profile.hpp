// SPDX-License-Identifier: MIT
// From measured tracks to the flow rate of a duct and how far its profile is from the laminar one.
#pragma once

#include <cstdint>
#include <vector>

#include "core/tables.hpp"
#include "simulation/flow_settings.hpp"

namespace rptv {

struct DuctProfileSettings {
  double rate_hz = 0;                              ///< time = frame / rate where the table has no t
  double centre_from = 0.8;                        ///< of the fastest velocity: where the centre begins
  double corner_from = 0.066, corner_below = 0.4;  ///< of the fastest: near walls and corners
};

/// Mean of |u / theory - 1| over a region, and how many velocities it is over.
struct ProfileError {
  double relative = 0;
  std::uint64_t velocities = 0;
};

struct DuctProfile {
  double flow_rate_ul_min = 0;  ///< that for which the theory fits all velocities best, least squares
  double true_flow_rate_ul_min = 0;
  ProfileError centre, corner;
};

/// Velocities along x from successive points of each track, compared with the series solution (DuctFlow) at the middle
/// between them. Rows by rising frame within a particle. Throws Error(bad_data) when no track has two points in the
/// duct, or when there is no time. Batch use.
DuctProfile measure_duct_profile(const std::vector<TrackRow>& tracks, const DuctSettings& duct,
                                 const DuctProfileSettings& settings = {});

}  // namespace rptv
