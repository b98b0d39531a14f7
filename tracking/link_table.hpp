// SPDX-License-Identifier: MIT
// Links a table of points into a table of tracks, frame by frame as the rows come.
#pragma once

#include <cstdint>
#include <string>

#include "core/tables.hpp"
#include "tracking/linker_counters.hpp"
#include "tracking/linker_settings.hpp"

namespace rptv {

/// Frame rate of tables that have no column t: velocities are then mm per frame, t counts frames.
inline constexpr double kOneFramePerSecond = 1.0;

struct LinkTableOptions {
  double rate_hz = kOneFramePerSecond;  ///< for tables without column t
  std::size_t smooth_frames = 0;        ///< rows are smoothed and come that many frames late; 0: as they are linked
  bool at_once = false;                 ///< every frame goes to the file when it is complete: somebody reads a pipe
};

/// Reads `points` to the end and writes a row per linked particle. Times come from the column t, else from frame /
/// rate_hz. Memory holds one frame and the linker's own. Throws Error(bad_data), naming `origin` and the frame, for a
/// frame of more than settings.max_particles points and for a t beyond ±9·10⁹ s; Error(configuration) for settings.
LinkerCounters link_table(PointsReader& points, const std::string& origin, const LinkerSettings& settings,
                          const LinkTableOptions& options, TracksWriter& tracks);

}  // namespace rptv
