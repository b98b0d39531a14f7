// SPDX-License-Identifier: MIT
// PTP by a camera's own features: switched on, waited for, looked at; for the aravis_*.cpp files only.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "acquisition/aravis_handle.hpp"

namespace rptv {

/// What the camera says of its clock.
struct PtpState {
  std::string state;           ///< "Slave", "Master", "Listening", … in the camera's word
  bool offset_known = false;   ///< some cameras do not tell
  std::int64_t offset_ns = 0;  ///< of its clock from the master's
  /// Its clock is the network's: it follows a master, or is the one that others follow.
  bool locked() const noexcept { return state == "Slave" || state == "Master"; }
  std::string text() const;  ///< ", PTP Slave, offset 120 ns"
};

/// Switches PTP on: PtpEnable, or GevIEEE1588 where a camera has the older names. Throws Error(configuration) when it
/// has neither, or refuses.
void enable_ptp(ArvCamera* camera, const std::string& name);

/// Waits until the clock is locked. `rest` is called between two looks with a duration in ns and says whether to go on.
/// Throws Error(unavailable) when it is not locked after `patience_s`. Not for real-time threads.
PtpState wait_for_ptp(ArvCamera* camera, const std::string& name, double patience_s,
                      const std::function<bool(std::int64_t)>& rest);

/// A few words with the camera. An empty state when it does not answer.
PtpState read_ptp(ArvCamera* camera);

}  // namespace rptv
