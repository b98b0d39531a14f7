// SPDX-License-Identifier: MIT
// A camera behind a network that goes down and comes back; the test has a network of its own for that.
#include <gtest/gtest.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/resource.h>

#include <cstring>

#include "core/descriptor.hpp"
#include "tests/acquisition/aravis_rig.hpp"
#include "tests/acquisition/camera_process.hpp"

namespace rptv {
namespace {

bool set_loopback(bool up) {
  const Descriptor any(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ifreq request{};
  std::strcpy(request.ifr_name, "lo");
  request.ifr_flags = up ? IFF_UP | IFF_RUNNING : 0;
  return ioctl(any.get(), SIOCSIFFLAGS, &request) == 0;
}

double cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec) * 1e-6;
}

/// Whether some half second soon comes in which this process uses less than half of a core.
bool idles(Rig& rig) {
  return eventually([&] {
    const double before_s = cpu_s();
    const std::int64_t end_ns = host_now_ns() + 500'000'000;
    rig.take_until([&] { return host_now_ns() >= end_ns; });
    return cpu_s() - before_s < 0.25;
  });
}

class AravisNetwork : public testing::TestWithParam<bool> {};

// In this process before Aravis starts any thread: threads and children are born into the new network.
TEST_P(AravisNetwork, goes_on_after_the_link_was_down_for_a_second) {
  if (unshare(CLONE_NEWNET) != 0) GTEST_SKIP() << "a network of its own needs root";
  ASSERT_TRUE(set_loopback(true));
  CameraProcess camera("127.0.0.1", 1);
  AravisSettings settings = settings_for("127.0.0.1");
  settings.packet_socket = GetParam();
  Rig rig(settings);
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= 20; })) << rig.status().problem;
  ASSERT_TRUE(set_loopback(false));
  const std::int64_t up_ns = host_now_ns() + 1'000'000'000;
  rig.take_until([&] { return host_now_ns() >= up_ns; });
  const std::uint64_t before = rig.received().images;
  ASSERT_TRUE(set_loopback(true));
  ASSERT_TRUE(rig.take_until([&] { return rig.received().images >= before + 30; })) << rig.status().problem;
  camera.rest();
  EXPECT_TRUE(rig.settles_at(camera.truth().sent)) << rig.accounted() << " of " << camera.truth().sent;
  EXPECT_EQ(rig.received().wrong, 0U);
  EXPECT_EQ(rig.status().sessions, 1U) << "a second without link is no reason to open it again";
  EXPECT_GT(rig.lost(), 20U) << "the link was down";
  EXPECT_TRUE(idles(rig)) << "a receiving thread spins since the link was down";
}

INSTANTIATE_TEST_SUITE_P(PacketSocket, AravisNetwork, testing::Bool());

}  // namespace
}  // namespace rptv
