// SPDX-License-Identifier: MIT
// Asks who is there, in GigE Vision's control protocol: cheap where opening an absent camera would block for seconds.
#pragma once

#include <cstdint>
#include <string>

namespace rptv {

/// What tells one GigE Vision camera from all others, whatever its address is.
struct GvcpIdentity {
  std::uint64_t mac = 0;
  std::string serial;
  bool operator==(const GvcpIdentity&) const = default;
  bool known() const noexcept { return mac != 0 || !serial.empty(); }
};

// Both may run on any thread but a real-time one, return at the answer, and give up after `patience_ns`.

/// Who answers at `address` (dotted); not known() when nobody does.
GvcpIdentity who_answers_at(const std::string& address, std::int64_t patience_ns);

/// Where the camera is now: asks all of every network that this machine has an address in. Empty when it does not
/// answer. A camera whose address fits none of the networks cannot be opened either, and is not found.
std::string find_address_of(const GvcpIdentity& identity, std::int64_t patience_ns);

}  // namespace rptv
