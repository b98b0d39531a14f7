// SPDX-License-Identifier: MIT
// A camera by its persistent name, which udev gives it, unplugged and plugged in. Runs in the emulated machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include "tests/acquisition/vivid_card.hpp"

namespace rptv {
namespace {

constexpr const char* kUdevd = "/lib/systemd/systemd-udevd";
constexpr const char* kByPath = "/dev/v4l/by-path/platform-vivid.0-video-index0";

void write(const std::string& file, const std::string& word) { std::ofstream(file) << word << std::flush; }

bool exists(const std::string& file) { return access(file.c_str(), F_OK) == 0; }

/// One program under two names.
pid_t start(const char* name, const char* argument, const char* option) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  execl(kUdevd, name, argument, option, nullptr);
  _exit(127);
}

/// The device manager, from construction to destruction.
class Udevd {
 public:
  Udevd() : pid_(start("systemd-udevd", nullptr, nullptr)) {
    EXPECT_TRUE(VividSession::wait_for([] { return exists("/run/udev/control"); }));
    int status = -1;
    waitpid(start("udevadm", "control", "--ping"), &status, 0);
    EXPECT_EQ(status, 0) << "it does not listen";
  }
  ~Udevd() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
    std::filesystem::remove_all("/run/udev");  // others take its absence for that of udev
  }
  Udevd(const Udevd&) = delete;
  Udevd& operator=(const Udevd&) = delete;

 private:
  const pid_t pid_;
};

TEST(V4l2VividUdev, names_a_camera_that_is_found_again_by_that_name) {
  if (!exists(kUdevd))
    GTEST_SKIP() << "no udev on the machine that built this one; scripts/install_dependencies brings it";
  const Udevd udevd;
  write("/sys/class/video4linux/video0/uevent", "add");  // as at boot
  ASSERT_TRUE(VividSession::wait_for([] { return exists(kByPath); }));
  V4l2Settings settings = webcam();
  settings.devices = {kByPath};
  VividSession session(settings);
  EXPECT_TRUE(session.take(2));
  write("/sys/bus/platform/drivers/vivid/unbind", "vivid.0");
  EXPECT_TRUE(VividSession::wait_for([&] { return session.status().state == DeviceState::lost && !exists(kByPath); }));
  EXPECT_THAT(session.status().problem, testing::HasSubstr(kByPath));
  write("/sys/bus/platform/drivers/vivid/bind", "vivid.0");
  EXPECT_TRUE(session.take(5));
  EXPECT_EQ(session.status().sessions, 2U);
  EXPECT_GE(session.counter("plug_events"), 1U) << "udev told";
}

}  // namespace
}  // namespace rptv
