// SPDX-License-Identifier: MIT
// The doctor on fabricated /sys and /proc trees, and once on this machine.
#include "daemon/doctor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>

#include "tests/proto/place.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

class Doctor : public testing::Test {
 protected:
  void put(const std::string& file, const std::string& text) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text << '\n';
  }
  void make_well() {
    put("sys/class/net/eth1/speed", "1000");
    put("sys/class/net/eth1/mtu", "9000");
    put("proc/sys/net/core/rmem_max", "33554432");
    put("sys/module/usbcore/parameters/usbfs_memory_mb", "1000");
    put("proc/self/limits",
        "Max locked memory         unlimited            unlimited            bytes\n"
        "Max realtime priority     99                   99                   ");
    put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
    put("proc/self/status", "Name:\trapidptv\nCapEff:\t0000000000002000");
    put("sys/class/ptp/ptp0/clock_name", "igb");
  }
  Finding find(const std::string& name, double bytes_per_second = 50e6) {
    for (const Finding& finding : examine(root_, {bytes_per_second}))
      if (finding.name == name) return finding;
    ADD_FAILURE() << "no finding " << name;
    return {};
  }
  const Place place_;
  const fs::path root_ = place_.file("");
};

TEST_F(Doctor, finds_nothing_wrong_with_a_machine_that_is_set_up) {
  make_well();
  const auto findings = examine(root_, {50e6});
  EXPECT_EQ(findings.size(), 9U);
  for (const Finding& finding : findings) {
    EXPECT_EQ(finding.verdict, Verdict::ok) << to_text(findings);
    EXPECT_EQ(finding.mend, "");
  }
  EXPECT_FALSE(has_problem(findings));
}

TEST_F(Doctor, calls_images_that_no_link_can_carry_a_problem) {
  make_well();
  EXPECT_EQ(find("link", 130e6).verdict, Verdict::problem);
  EXPECT_TRUE(has_problem(examine(root_, {130e6})));
}

TEST_F(Doctor, warns_of_each_thing_that_is_amiss_with_the_command_that_mends_it) {
  make_well();
  put("sys/class/net/eth1/mtu", "1500");
  put("proc/sys/net/core/rmem_max", "212992");
  put("sys/module/usbcore/parameters/usbfs_memory_mb", "16");
  put("proc/self/limits",
      "Max locked memory         8388608              8388608              bytes\n"
      "Max realtime priority     0                    0                    ");
  put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave");
  put("proc/self/status", "CapEff:\t0000000000000000");
  fs::remove_all(root_ / "sys/class/ptp");
  for (const auto& [name, measured, mend] :
       std::vector<std::array<std::string, 3>>{{"MTU of eth1", "1500", "ip link set eth1 mtu 9000"},
                                               {"net.core.rmem_max", "212992", "sysctl -w net.core.rmem_max=8388608"},
                                               {"usbfs_memory_mb", "16", "usbfs_memory_mb"},
                                               {"rtprio", "0", "LimitRTPRIO"},
                                               {"memlock", "8388608", "LimitMEMLOCK"},
                                               {"CPU governor", "powersave", "scaling_governor"},
                                               {"packet socket", "CAP_NET_RAW missing", "setcap"},
                                               {"PTP clocks", "0", "ptp4l"}}) {
    const Finding finding = find(name);
    EXPECT_EQ(finding.verdict, Verdict::warning) << name;
    EXPECT_EQ(finding.measured, measured) << name;
    EXPECT_THAT(finding.mend, testing::HasSubstr(mend)) << name;
  }
}

TEST_F(Doctor, says_so_when_nothing_can_be_read) {
  EXPECT_EQ(find("net.core.rmem_max").measured, "cannot be read");
  EXPECT_EQ(find("memlock").measured, "cannot be read");
  EXPECT_FALSE(has_problem(examine(root_, {}))) << "what is not known is no problem";
}

TEST(DoctorHere, examines_this_machine) {
  const auto findings = examine("/", {});
  EXPECT_GE(findings.size(), 6U);
  for (const Finding& finding : findings) {
    if (finding.name == "memlock") {
      EXPECT_NE(finding.measured, "cannot be read") << to_json(findings);
    }
  }
}

}  // namespace
}  // namespace rptv
