// SPDX-License-Identifier: MIT
// Velocity by velocity against the theory.
#include "simulation/duct_profile.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "core/error.hpp"
#include "simulation/duct_flow.hpp"

namespace rptv {

namespace {

double time_of(const TrackRow& row, const DuctProfileSettings& settings) {
  if (!std::isnan(row.t_s)) return row.t_s;
  if (settings.rate_hz > 0) return static_cast<double>(row.frame) / settings.rate_hz;
  throw Error(ExitCode::bad_data, fmt::format("the tracks have no time (frame {}, particle {}): write a column t, or "
                                              "give the frame rate",
                                              row.frame, row.particle));
}

void add(ProfileError& error, double relative) noexcept {
  error.relative += std::abs(relative);
  ++error.velocities;
}

}  // namespace

DuctProfile measure_duct_profile(const std::vector<TrackRow>& tracks, const DuctSettings& duct,
                                 const DuctProfileSettings& settings) {
  const DuctFlow flow(duct);
  const double fastest = flow.velocity_mm_s(0, 0);
  std::map<std::uint64_t, TrackRow> last;
  double along = 0, square = 0;
  DuctProfile profile;
  for (const auto& row : tracks) {
    const auto [before, fresh] = last.try_emplace(row.particle, row);
    if (fresh) continue;
    const TrackRow& from = before->second;
    const double theory = flow.velocity_mm_s((row.y_mm + from.y_mm) / 2, (row.z_mm + from.z_mm) / 2);
    const double u = (row.x_mm - from.x_mm) / (time_of(row, settings) - time_of(from, settings));
    along += u * theory, square += theory * theory;
    const double share = theory / fastest;
    if (share > settings.centre_from) add(profile.centre, u / theory - 1);
    if (share > settings.corner_from && share < settings.corner_below) add(profile.corner, u / theory - 1);
    before->second = row;
  }
  if (!(square > 0))
    throw Error(ExitCode::bad_data,
                "no track has two points inside the duct; check the duct's size and the frame of reference (object "
                "space, mm, the duct's axis along x)");
  for (ProfileError* error : {&profile.centre, &profile.corner})
    if (error->velocities > 0) error->relative /= static_cast<double>(error->velocities);
  profile.true_flow_rate_ul_min = duct.flow_rate_ul_min;
  profile.flow_rate_ul_min = duct.flow_rate_ul_min * along / square;
  return profile;
}

}  // namespace rptv
