// SPDX-License-Identifier: MIT
// An open file that is closed once.
#pragma once

#include <unistd.h>

#include <cerrno>
#include <utility>

namespace rptv {

/// Move-only; closes what it holds unless that is a standard stream. -1 is none.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) noexcept : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() { close(); }

  int get() const noexcept { return number_; }
  bool open() const noexcept { return number_ >= 0; }
  /// errno of close(2), 0 when all is well. Idempotent.
  int close() noexcept {
    const int number = std::exchange(number_, -1);
    return number > STDERR_FILENO && ::close(number) != 0 ? errno : 0;
  }

 private:
  int number_;
};

}  // namespace rptv
