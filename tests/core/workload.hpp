// SPDX-License-Identifier: MIT
// How much the contended tests do: much, and less where a sanitizer slows every access.
#pragma once

#include <cstdint>

namespace rptv {

#if defined(__SANITIZE_THREAD__)
inline constexpr bool kUnderThreadSanitizer = true;
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
inline constexpr bool kUnderThreadSanitizer = true;
#else
inline constexpr bool kUnderThreadSanitizer = false;
#endif
#else
inline constexpr bool kUnderThreadSanitizer = false;
#endif

/// `full` rounds, a fortieth of it under ThreadSanitizer.
constexpr std::uint64_t rounds(std::uint64_t full) { return kUnderThreadSanitizer ? full / 40 : full; }

}  // namespace rptv
