// SPDX-License-Identifier: MIT
// A folder of its own for a test's sockets and files, and waiting with a bound.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "core/clock.hpp"

namespace rptv {

/// Made by the constructor, removed with everything in it by the destructor.
class Place {
 public:
  Place() {
    std::string name = "/tmp/rapidptv-test-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) std::abort();
    folder_ = name;
  }
  ~Place() { std::filesystem::remove_all(folder_); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  std::filesystem::path file(const std::string& name) const { return folder_ / name; }
  std::string ipc(const std::string& name = "tracks.sock") const { return "ipc://" + file(name).string(); }
  std::filesystem::path write(const std::string& name, const std::string& text, unsigned mode = 0600) const {
    std::ofstream(file(name)) << text;
    std::filesystem::permissions(file(name), static_cast<std::filesystem::perms>(mode));
    return file(name);
  }

 private:
  std::filesystem::path folder_;
};

/// Calls `condition` until it is true; false when that took longer than 20 s. The condition itself should wait a
/// little.
template <class Condition>
bool eventually(Condition condition) {
  const std::int64_t deadline_ns = host_now_ns() + 20'000'000'000;
  while (host_now_ns() < deadline_ns)
    if (condition()) return true;
  return false;
}

}  // namespace rptv
