// SPDX-License-Identifier: MIT
// From the words of [sync] to the options of the intake.
#include "acquisition/sync_settings.hpp"

#include <cmath>

#include "core/error.hpp"

namespace rptv {

void SyncSettings::apply(IntakeOptions& options, std::size_t cameras, std::int64_t period_ns) const {
  if (cameras <= 1) return;
  if (mode == "unset")
    throw Error(ExitCode::configuration,
                "sync.mode is unset and the source has " + std::to_string(cameras) +
                    " cameras; say what keeps them in step: 'hardware', 'ptp', 'device' or 'none'");
  if (const std::string line = confusion(cameras, period_ns); !line.empty()) throw Error(ExitCode::configuration, line);
  options.pairing.by = PairBy::index_and_time;
  if (mode == "device") options.pairing.by = PairBy::time;
  if (mode == "none") options.pairing.by = PairBy::index;
  options.pairing.ptp = mode == "ptp";
  options.pairing.tolerance_ns = std::llround(tolerance_us * 1e3);
  options.bound_ns = std::llround(bound_ms * 1e6);
  options.stall_ns = options.bound_ns;
}

std::string SyncSettings::confusion(std::size_t cameras, std::int64_t period_ns) const {
  if (cameras <= 1 || mode == "none" || period_ns <= 0 || 2000 * tolerance_us < static_cast<double>(period_ns))
    return {};
  return "sync.tolerance_us = " + std::to_string(std::llround(tolerance_us)) +
         " does not tell one frame from the next, " + std::to_string(period_ns / 1000) + " us later; set it below " +
         std::to_string(period_ns / 2000);
}

std::string SyncSettings::warning(std::size_t cameras) const {
  if (cameras <= 1 || mode != "none") return {};
  return "sync.mode = 'none': frames are paired by their counts and nothing checks that they are of one instant; "
         "choose 'hardware', 'ptp' or 'device'";
}

}  // namespace rptv
