// SPDX-License-Identifier: MIT
// What a user says about how several cameras are synchronised: section [sync] of the configuration.
#pragma once

#include <cstdint>
#include <string>

#include "acquisition/intake.hpp"
#include "core/settings.hpp"

namespace rptv {

struct SyncSettings {
  std::string mode = "unset";
  double tolerance_us = 1000;
  double bound_ms = 100;

  void fields(FieldList& list) {
    list.choice("mode", mode, {"unset", "hardware", "ptp", "device", "none"},
                "what makes frames of several cameras belong together, and must be chosen for them: 'hardware' one "
                "trigger for all, 'ptp' clocks of the cameras kept by PTP, 'device' free-running cameras paired by "
                "time alone, 'none' frame counts that nothing checks");
    list.number("tolerance_us", tolerance_us, 0, 1e9,
                "how far the times of one set may differ, us; less than half of the frame period");
    list.number("bound_ms", bound_ms, 0.1, 1e6, "an incomplete set waits no longer for its other frames, ms");
  }

  /// Sets how `cameras` live cameras are paired. `period_ns`: between their frames, 0 when nobody knows. Throws
  /// Error(configuration): several cameras and no mode, or a tolerance that does not tell one frame from the next.
  void apply(IntakeOptions& options, std::size_t cameras, std::int64_t period_ns) const;

  /// What is wrong with the tolerance for frames that follow each other after `period_ns`; empty when nothing is, or
  /// when the period is 0: not known.
  std::string confusion(std::size_t cameras, std::int64_t period_ns) const;

  /// What every status must say about this choice; empty when it is a good one.
  std::string warning(std::size_t cameras) const;
};

}  // namespace rptv
