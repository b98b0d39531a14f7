// SPDX-License-Identifier: MIT
// The linker between two tables: rows to particles, seconds to nanoseconds, tracks to rows.
#include "tracking/link_table.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <utility>

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

/// A linker with its memory, as large as the frames need: a table may have fewer points than the settings allow, and
/// nobody says before how many.
struct GrowingLinker {
  explicit GrowingLinker(const LinkerSettings& most) : most_(most) { most.check(); }

  /// Makes room for a frame of `points`, for all of which tracks may begin.
  void fit(std::size_t points) {
    const std::size_t live = linker ? linker->live_tracks() : 0;
    if (linker && points <= particles.capacity() && live + points <= linker->capacity()) return;
    const auto at_most = [](std::size_t wanted, std::int64_t most) {
      return std::min(static_cast<std::int64_t>(std::bit_ceil(wanted)), most);
    };
    LinkerSettings settings = most_;
    settings.max_particles = at_most(std::max(points, particles.capacity()), most_.max_particles);
    settings.max_tracks = at_most(2 * (live + points), std::max(most_.max_tracks, most_.max_particles));
    if (linker && linker->capacity() >= static_cast<std::size_t>(settings.max_tracks) &&
        particles.capacity() >= static_cast<std::size_t>(settings.max_particles))
      return;
    auto larger = std::make_unique<Linker>(settings);
    if (linker) larger->restore(linker->snapshot());
    linker = std::move(larger);
    particles = Particles(static_cast<std::size_t>(settings.max_particles));
    tracks = Tracks(linker->capacity());
  }

  std::unique_ptr<Linker> linker;
  Particles particles;
  Tracks tracks;

 private:
  LinkerSettings most_;
};

}  // namespace

LinkerCounters link_table(PointsReader& points, const std::string& origin, const LinkerSettings& settings,
                          const LinkTableOptions& options, TracksWriter& tracks) {
  GrowingLinker growing(settings);
  FixedLagSmoother smoother(options.smooth_frames);
  SmoothedFrame smoothed;
  PointFrame frame;
  while (points.next(frame)) {
    if (frame.points.size() > static_cast<std::size_t>(settings.max_particles))
      throw Error(ExitCode::bad_data, origin + ": frame " + std::to_string(frame.frame) + " has " +
                                          std::to_string(frame.points.size()) + " points; give --max-particles " +
                                          std::to_string(frame.points.size()) + " or more");
    growing.fit(frame.points.size());
    growing.particles.clear();
    for (const PointRow& p : frame.points)
      growing.particles.push({p.x_mm, p.y_mm, p.z_mm, p.residual_mm, p.support, p.covariance_mm2});
    const double t_s = points.has_time() ? frame.t_s : static_cast<double>(frame.frame) / options.rate_hz;
    growing.linker->next(growing.particles, frame.frame, to_ns(t_s, frame.frame, origin), growing.tracks);
    if (options.smooth_frames == 0) {
      tracks.write(frame.frame, t_s, growing.tracks);
    } else {
      smoother.push(*growing.linker, frame.frame, t_s, growing.tracks);
      while (smoother.pop(smoothed)) tracks.write(smoothed.frame, smoothed.t_s, smoothed.tracks);
    }
    if (options.at_once) tracks.csv().flush();
  }
  while (smoother.pop(smoothed, true)) tracks.write(smoothed.frame, smoothed.t_s, smoothed.tracks);
  return growing.linker ? growing.linker->counters() : LinkerCounters{};
}

}  // namespace rptv
