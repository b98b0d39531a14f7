// SPDX-License-Identifier: MIT
// What happens when a consumer falls behind its producer: the three policies, as types.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "core/losses.hpp"

namespace rptv {

/// Live view: the consumer gets the newest value; what it had no time for is lost as `superseded`.
struct Newest {};
/// Recordings: the producer waits for room (up to `depth` values wait); nothing is lost.
struct Lossless {
  std::size_t depth = 8;  ///< 0 counts as 1
};
/// Bounded delay: at most `depth` values wait; what comes to a full queue is lost as `over_bound`.
struct Bounded {
  std::size_t depth = 8;  ///< 0 counts as 1
};
using HandOverPolicy = std::variant<Newest, Lossless, Bounded>;

/// How many values may wait under this policy; at least 1.
inline std::size_t depth_of(const HandOverPolicy& policy) noexcept {
  if (const auto* lossless = std::get_if<Lossless>(&policy)) return std::max<std::size_t>(lossless->depth, 1);
  if (const auto* bounded = std::get_if<Bounded>(&policy)) return std::max<std::size_t>(bounded->depth, 1);
  return 1;
}

/// What a consumer gets from a hand-over.
enum class Taken : std::uint8_t { value, timeout, closed };

/// What became of a value that a producer gave to a hand-over.
enum class Stored : std::uint8_t { yes, replaced_older, no_room, closed };

/// The cause to count for everything but `yes`; `bound_cause` is that of a full queue.
constexpr LossCause cause_of(Stored stored, LossCause bound_cause) noexcept {
  if (stored == Stored::closed) return LossCause::after_close;
  return stored == Stored::replaced_older ? LossCause::superseded : bound_cause;
}

}  // namespace rptv
