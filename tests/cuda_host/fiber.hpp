// SPDX-License-Identifier: MIT
// One stack that a CUDA thread runs on until it must wait for others; cheap to switch to, and to run thread after
// thread on.
#pragma once

#include <cstddef>

namespace rptv::cuda_host {

class Fiber {
 public:
  /// `body` is called again whenever it has returned and the fiber is resumed.
  explicit Fiber(void (*body)());
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Runs the fiber until it leaves or its body returns. One fiber runs at a time, in the whole process.
  void resume();

  /// Called on a fiber: back to resume().
  static void leave();

  /// Tells ThreadSanitizer that what the fiber has done comes before whoever acquires the token.
  void release_order(void* token) const;

  /// What a fiber does in its life; for fiber.cpp.
  [[noreturn]] void live();

 private:
  void (*body_)();
  void* mapping_;            // guard page, then the stack
  void* context_ = nullptr;  // where to continue
  void* fake_stack_ = nullptr;
  void* identity_;  // this fiber as ThreadSanitizer knows it; tied to the stack
};

}  // namespace rptv::cuda_host
