// SPDX-License-Identifier: MIT
// Events of devices through libudev.
#include "acquisition/v4l2_watch.hpp"

#ifdef RPTV_UDEV
#include <libudev.h>
#include <unistd.h>

#include <string_view>
#endif

namespace rptv {

#ifdef RPTV_UDEV

V4l2Watch::V4l2Watch() noexcept {
  udev* library = udev_new();
  if (library == nullptr) return;
  const bool runs = access("/run/udev/control", F_OK) == 0;
  monitor_.reset(udev_monitor_new_from_netlink(library, runs ? "udev" : "kernel"));
  udev_unref(library);  // the monitor holds it
  if (monitor_ && (udev_monitor_filter_add_match_subsystem_devtype(monitor_.get(), "video4linux", nullptr) < 0 ||
                   udev_monitor_enable_receiving(monitor_.get()) < 0))
    monitor_.reset();
}

int V4l2Watch::descriptor() const noexcept { return monitor_ ? udev_monitor_get_fd(monitor_.get()) : -1; }

unsigned V4l2Watch::take() noexcept {
  unsigned came = 0;
  while (udev_device* device = monitor_ ? udev_monitor_receive_device(monitor_.get()) : nullptr) {
    const char* action = udev_device_get_action(device);
    if (action != nullptr && std::string_view(action) != "remove") ++came;
    udev_device_unref(device);
  }
  return came;
}

void V4l2Watch::Close::operator()(udev_monitor* monitor) const noexcept { udev_monitor_unref(monitor); }

#else

V4l2Watch::V4l2Watch() noexcept = default;
int V4l2Watch::descriptor() const noexcept { return -1; }
unsigned V4l2Watch::take() noexcept { return 0; }
void V4l2Watch::Close::operator()(udev_monitor*) const noexcept {}

#endif

}  // namespace rptv
