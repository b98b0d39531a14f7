// SPDX-License-Identifier: MIT
// A move-only value that knows whether it is alive: what the tests send through rings and mailboxes.
#pragma once

#include <cstdint>
#include <utility>

namespace rptv {

/// `key` 0: moved from or never filled.
class Tracer {
 public:
  Tracer() = default;
  explicit Tracer(std::uint64_t key) noexcept : key_(key), copy_(~key) {}
  Tracer(Tracer&& other) noexcept : key_(std::exchange(other.key_, 0)), copy_(std::exchange(other.copy_, ~0ULL)) {}
  Tracer& operator=(Tracer&& other) noexcept {
    key_ = std::exchange(other.key_, 0);
    copy_ = std::exchange(other.copy_, ~0ULL);
    return *this;
  }
  std::uint64_t key() const noexcept { return key_; }
  bool torn() const noexcept { return copy_ != ~key_; }  ///< half of it is another value's

 private:
  std::uint64_t key_ = 0;
  std::uint64_t copy_ = ~0ULL;
};

}  // namespace rptv
