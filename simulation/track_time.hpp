// SPDX-License-Identifier: MIT
// When a row of a tracks table was seen.
#pragma once

#include <fmt/format.h>

#include <cmath>

#include "core/error.hpp"
#include "core/tables.hpp"

namespace rptv {

/// Its t, s; frame / `rate_hz` where the table has none. Throws Error(bad_data) when there is neither.
inline double time_of(const TrackRow& row, double rate_hz) {
  if (!std::isnan(row.t_s)) return row.t_s;
  if (rate_hz > 0) return static_cast<double>(row.frame) / rate_hz;
  throw Error(ExitCode::bad_data, fmt::format("the tracks have no time (frame {}, particle {}): write a column t, or "
                                              "give the frame rate",
                                              row.frame, row.particle));
}

}  // namespace rptv
