// SPDX-License-Identifier: MIT
// The doctor on fabricated /sys and /proc trees, and once on this machine.
#include "daemon/doctor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <fstream>

#include "daemon/doctor_plan.hpp"
#include "tests/daemon/small_run.hpp"
#include "tests/proto/place.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

class Doctor : public ::testing::Test {
 protected:
  void put(const std::string& file, const std::string& text) {
    fs::create_directories((root_ / file).parent_path());
    std::ofstream(root_ / file) << text << '\n';
  }
  void make_well() {
    put("sys/class/net/eth1/speed", "1000");
    put("sys/class/net/eth1/mtu", "9000");
    put("sys/class/net/eth2/speed", "10000");
    put("sys/class/net/eth2/mtu", "9000");
    put("proc/net/route",
        "Iface\tDestination\tGateway \tFlags\tRefCnt\tUse\tMetric\tMask\t\tMTU\tWindow\tIRTT\n"
        "eth2\t00000000\t0101A8C0\t0003\t0\t0\t100\t00000000\t0\t0\t0\n"
        "eth2\t0000000A\t00000000\t0001\t0\t0\t0\t000000FF\t0\t0\t0\n"
        "eth1\t0001000A\t00000000\t0001\t0\t0\t0\t00FFFFFF\t0\t0\t0");
    put("proc/sys/net/core/rmem_max", "33554432");
    put("sys/module/usbcore/parameters/usbfs_memory_mb", "1000");
    put("proc/self/limits",
        "Max locked memory         unlimited            unlimited            bytes\n"
        "Max realtime priority     99                   99                   ");
    put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
    put("proc/self/status", "Name:\trapidptv\nCapEff:\t0000000000002000");
    put("sys/class/ptp/ptp0/clock_name", "igb");
  }
  Finding find(const std::string& name, const std::vector<CameraLoad>& cameras = {{"10.0.1.7", 50e6}}) {
    for (const Finding& finding : examine(root_, cameras))
      if (finding.name == name) return finding;
    ADD_FAILURE() << "no finding " << name;
    return {};
  }
  const Place place_;
  const fs::path root_ = place_.file("");
};

TEST_F(Doctor, finds_nothing_wrong_with_a_machine_that_is_set_up) {
  make_well();
  const auto findings = examine(root_, {{"10.0.1.7", 50e6}});
  EXPECT_EQ(findings.size(), 9U);
  for (const Finding& finding : findings) {
    EXPECT_EQ(finding.verdict, Verdict::ok) << to_text(findings);
    EXPECT_EQ(finding.mend, "");
  }
  EXPECT_FALSE(has_problem(findings));
}

TEST_F(Doctor, calls_images_that_their_own_link_cannot_carry_a_problem) {
  make_well();
  const std::vector<CameraLoad> both{{"10.0.1.7", 60e6}, {"10.0.1.8", 60e6}};
  const Finding link = find("link eth1", both);
  EXPECT_EQ(link.verdict, Verdict::problem) << "the link's, not the fastest one's speed counts";
  EXPECT_EQ(link.measured, "1000 Mbit/s");
  EXPECT_EQ(link.needed, "1021 Mbit/s for 10.0.1.7, 10.0.1.8");
  EXPECT_TRUE(has_problem(examine(root_, both)));
  EXPECT_EQ(find("link eth2", {{"10.0.1.7", 60e6}, {"10.0.2.8", 60e6}}).verdict, Verdict::ok);
}

TEST_F(Doctor, says_how_a_camera_is_not_reached) {
  make_well();
  EXPECT_EQ(find("route to 169.254.3.3", {{"169.254.3.3", 1e6}}).measured, "through a gateway on eth2");
  put("proc/net/route", "Iface\tDestination");
  const Finding none = find("route to 10.0.1.7");
  EXPECT_EQ(none.verdict, Verdict::problem);
  EXPECT_THAT(none.mend, ::testing::HasSubstr("ip addr add"));
}

TEST_F(Doctor, asks_nothing_of_a_link_for_cameras_on_loopback_and_on_usb) {
  make_well();
  EXPECT_EQ(find("link lo", {{"127.0.0.9", 1e12}}).verdict, Verdict::ok);
  EXPECT_TRUE(examine_links(root_, {{"Basler-acA1920-40um", 50e6}}).empty());
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
    EXPECT_THAT(finding.mend, ::testing::HasSubstr(mend)) << name;
  }
}

TEST_F(Doctor, says_so_when_nothing_can_be_read) {
  EXPECT_EQ(find("net.core.rmem_max").measured, "cannot be read");
  EXPECT_EQ(find("memlock").measured, "cannot be read");
  EXPECT_FALSE(has_problem(examine(root_, {}))) << "what is not known is no problem";
}

TEST(DoctorHere, measures_what_the_disk_takes_in_and_leaves_nothing_there) {
  const Place place;
  const Finding enough = examine_disk(place.file(""), 1);
  EXPECT_EQ(enough.verdict, Verdict::ok) << enough.measured;
  EXPECT_THAT(enough.measured, ::testing::MatchesRegex("[0-9]+ MB/s"));
  EXPECT_TRUE(fs::is_empty(place.file("")));
  const Finding slow = examine_disk(place.file(""), 1e15);
  EXPECT_EQ(slow.verdict, Verdict::warning);
  EXPECT_THAT(slow.mend, ::testing::HasSubstr("writer_backlog"));
  EXPECT_EQ(examine_disk(place.file("absent"), 1).verdict, Verdict::problem);
}

TEST(DoctorPlan, is_what_the_cameras_send_and_what_the_run_writes) {
  const testing::SmallRun run(2);
  Config config = run.config();
  config.output.points = (run.folder() / "points.csv").string();
  config.output.tracks = (run.folder() / "tracks.csv").string();
  const DoctorPlan plan = plan_of(config);
  EXPECT_TRUE(plan.cameras.empty()) << "a replay sends nothing over a link";
  EXPECT_EQ(plan.output_folders, std::vector<fs::path>{run.folder()}) << "once";
  EXPECT_GT(plan.output_bytes_per_second, 0);
  EXPECT_TRUE(plan.findings.empty());
}

TEST(DoctorPlan, tells_of_cameras_that_do_not_answer_and_goes_on) {
  Config config;
  config.source.kind = "v4l2";
  config.v4l2.devices = {"/dev/no-such-camera"};
  const DoctorPlan plan = plan_of(config);
  ASSERT_EQ(plan.findings.size(), 1U);
  EXPECT_THAT(plan.findings[0].measured, ::testing::HasSubstr("/dev/no-such-camera"));
  EXPECT_EQ(plan.cameras.size(), 1U);
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
