// SPDX-License-Identifier: MIT
// The service manager's end of sd_notify: a real datagram socket that NOTIFY_SOCKET points to while it exists.
#pragma once

#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>
#include <string>

namespace rptv {

class NotifySocket {
 public:
  NotifySocket() {
    char folder[] = "/tmp/rptv-notify-XXXXXX";
    if (mkdtemp(folder) == nullptr) throw std::runtime_error("mkdtemp");
    folder_ = folder;
    path_ = folder_ + "/notify";
    descriptor_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path_.c_str(), path_.size() + 1);
    if (bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("bind " + path_);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    close(descriptor_);
    unlink(path_.c_str());
    rmdir(folder_.c_str());
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  /// The next datagram; empty when none came within `timeout_ms` (0: what is there already).
  std::string receive(int timeout_ms) {
    pollfd waits{descriptor_, POLLIN, 0};
    if (poll(&waits, 1, timeout_ms) <= 0) return {};
    char text[4096];
    const ssize_t size = recv(descriptor_, text, sizeof text, 0);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size)) : std::string{};
  }

 private:
  std::string folder_, path_;
  int descriptor_ = -1;
};

}  // namespace rptv
