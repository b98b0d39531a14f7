// SPDX-License-Identifier: MIT
// The linker between two tables: rows to particles, seconds to nanoseconds, tracks to rows.
#include "tracking/link_table.hpp"

#include <cmath>

#include "core/error.hpp"
#include "tracking/linker.hpp"
#include "tracking/smoother.hpp"

namespace rptv {

namespace {

constexpr double kLatestS = 9e9;  // more ns do not fit 64 bits

std::int64_t to_ns(double t_s, std::uint64_t frame, const std::string& origin) {
  if (!(std::abs(t_s) <= kLatestS))
    throw Error(ExitCode::bad_data, origin + ": frame " + std::to_string(frame) + " is at t = " + std::to_string(t_s) +
                                        " s; give times between -9e9 and 9e9 s");
  return static_cast<std::int64_t>(std::llround(t_s * 1e9));
}

}  // namespace

LinkerCounters link_table(PointsReader& points, const std::string& origin, const LinkerSettings& settings,
                          const LinkTableOptions& options, TracksWriter& tracks) {
  Linker linker(settings);
  Particles particles(static_cast<std::size_t>(settings.max_particles));
  Tracks linked(linker.capacity());
  FixedLagSmoother smoother(options.smooth_frames);
  SmoothedFrame smoothed;
  PointFrame frame;
  while (points.next(frame)) {
    if (frame.points.size() > particles.capacity())
      throw Error(ExitCode::bad_data, origin + ": frame " + std::to_string(frame.frame) + " has " +
                                          std::to_string(frame.points.size()) + " points; give --max-particles " +
                                          std::to_string(frame.points.size()) + " or more");
    particles.clear();
    for (const PointRow& p : frame.points)
      particles.push({p.x_mm, p.y_mm, p.z_mm, p.residual_mm, p.support, p.covariance_mm2});
    const double t_s = points.has_time() ? frame.t_s : static_cast<double>(frame.frame) / options.rate_hz;
    linker.next(particles, frame.frame, to_ns(t_s, frame.frame, origin), linked);
    if (options.smooth_frames == 0) {
      tracks.write(frame.frame, t_s, linked);
    } else {
      smoother.push(linker, frame.frame, t_s, linked);
      while (smoother.pop(smoothed)) tracks.write(smoothed.frame, smoothed.t_s, smoothed.tracks);
    }
    if (options.at_once) tracks.csv().flush();
  }
  while (smoother.pop(smoothed, true)) tracks.write(smoothed.frame, smoothed.t_s, smoothed.tracks);
  return linker.counters();
}

}  // namespace rptv
