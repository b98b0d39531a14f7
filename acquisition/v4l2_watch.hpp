// SPDX-License-Identifier: MIT
// Says when a video device is plugged in.
#pragma once

#include <memory>

struct udev_monitor;

namespace rptv {

/// Listens from its construction on: to udev where it runs (its links and permissions are then in place), else to the
/// kernel. Without libudev at build time, or without a socket for it, it hears nothing. One thread at a time.
class V4l2Watch {
 public:
  V4l2Watch() noexcept;

  /// Readable when something was heard; -1: nothing ever will be.
  int descriptor() const noexcept;
  /// Takes all that was heard; how many times a device came or changed.
  unsigned take() noexcept;

 private:
  struct Close {
    void operator()(udev_monitor* monitor) const noexcept;
  };
  std::unique_ptr<udev_monitor, Close> monitor_;
};

}  // namespace rptv
