// SPDX-License-Identifier: MIT
// A camera in a process of its own that is killed, frozen and moved to another address while it streams.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>

#include "tests/acquisition/aravis_rig.hpp"
#include "tests/acquisition/camera_process.hpp"

namespace rptv {
namespace {

/// What a leak would make grow.
struct Holdings {
  std::size_t descriptors = 0, heap_bytes = 0, resident_kib = 0;

  static Holdings now() {
    Holdings h;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) h.descriptors += entry.exists();
    const struct mallinfo2 heap = mallinfo2();
    h.heap_bytes = heap.uordblks + heap.hblkhd;
    std::size_t total = 0;
    std::ifstream("/proc/self/statm") >> total >> h.resident_kib;
    h.resident_kib *= 4;
    return h;
  }
};

std::uint64_t kills_wanted() {
  const char* text = std::getenv("RPTV_CAMERA_KILLS");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : 3;
}

bool streams_in_session(Rig& rig, std::uint64_t session, std::uint64_t images) {
  const std::uint64_t before = rig.received().images;
  return rig.take_until([&] {
    return CameraProcess::session_of(rig.received().newest) == session && rig.received().images >= before + images;
  });
}

TEST(AravisHardLife, is_back_soon_after_each_kill_without_leak_or_stale_image) {
  const std::uint64_t kills = kills_wanted();
  auto camera = std::make_unique<CameraProcess>("127.0.21.1", 1);
  Rig rig(settings_for("127.0.21.1"));
  ASSERT_TRUE(streams_in_session(rig, 1, 20)) << rig.status().problem;
  std::vector<double> back_ms;
  Holdings first;
  for (std::uint64_t session = 2; session <= kills + 1; ++session) {
    camera->kill();
    rig.lives().over(session - 1, camera->truth());
    if (session % 10 == 5) {  // gone for so long that the driver gives the camera up by itself
      ASSERT_TRUE(rig.take_until([&] { return rig.status().state == DeviceState::lost; }));
    }
    camera = std::make_unique<CameraProcess>("127.0.21.1", session);
    ASSERT_TRUE(streams_in_session(rig, session, 1)) << rig.status().problem;
    back_ms.push_back(static_cast<double>(host_now_ns() - camera->truth().first_answer_ns) * 1e-6);
    ASSERT_TRUE(streams_in_session(rig, session, 20)) << rig.status().problem;
    EXPECT_EQ(rig.status().sessions, session);
    if (session == 3) first = Holdings::now();  // Aravis and GLib keep what they made for the first reconnection
  }
  const Holdings last = Holdings::now();
  camera->rest();
  const CameraLives& lives = rig.lives();
  rig.lives().over(kills + 1, camera->truth());
  const std::uint64_t last_image = (kills + 1) << 32 | camera->truth().sent;
  rig.take_until([&] { return rig.accounted() >= lives.least() || rig.received().newest == last_image; });
  EXPECT_TRUE(lives.explain(rig.accounted(), rig.estimated()))
      << rig.accounted() << " of " << lives.least() << " to " << lives.most();
  EXPECT_EQ(rig.received().wrong, 0U) << "an image of an earlier session, a damaged one, or an index that fell";
  EXPECT_EQ(last.descriptors, first.descriptors);
  EXPECT_LE(last.heap_bytes, first.heap_bytes + (64 << 10) * kills);
  std::sort(back_ms.begin(), back_ms.end());
  EXPECT_LT(back_ms.back(), 30'000);
  std::printf(
      "%zu kills: back P50 %.0f ms, max %.0f ms after the first answer; %zu descriptors; heap %+lld bytes and "
      "resident %+lld KiB over %lld kills; sent %llu to %llu, accounted %llu, "
      "next to an outage %llu, estimated %llu\n",
      back_ms.size(), back_ms[back_ms.size() / 2], back_ms.back(), last.descriptors,
      static_cast<long long>(last.heap_bytes - first.heap_bytes),
      static_cast<long long>(last.resident_kib - first.resident_kib), static_cast<long long>(kills) - 2,
      static_cast<unsigned long long>(lives.least()), static_cast<unsigned long long>(lives.most()),
      static_cast<unsigned long long>(rig.accounted()), static_cast<unsigned long long>(lives.next_to_outages()),
      static_cast<unsigned long long>(rig.estimated()));
}

TEST(AravisHardLife, counts_what_an_outage_cost_apart_from_what_is_known) {
  auto camera = std::make_unique<CameraProcess>("127.0.21.2", 1);
  Rig rig(settings_for("127.0.21.2"));
  ASSERT_TRUE(streams_in_session(rig, 1, 20)) << rig.status().problem;
  camera->rest();
  const std::uint64_t sent = camera->truth().sent;
  ASSERT_TRUE(rig.settles_at(sent)) << rig.accounted() << " of " << sent;
  const std::uint64_t last_index = rig.received().newest_index;
  camera->kill();
  camera = std::make_unique<CameraProcess>("127.0.21.2", 2);
  ASSERT_TRUE(streams_in_session(rig, 2, 1)) << rig.status().problem;
  const Outage outage = rig.status().last_outage;
  EXPECT_EQ(outage.number, 1U);
  EXPECT_EQ(outage.first_frame, rig.received().newest_index);
  EXPECT_EQ(outage.frames_due, rig.estimated());
  EXPECT_GT(outage.duration_ns, 0);
  const auto counter = [&](const std::string& name) {
    for (const DeviceCounter& one : rig.status().counters)
      if (one.name == name) return one.count;
    return std::uint64_t{0};
  };
  EXPECT_EQ(counter("outages"), 1U);
  // 100 frames per second: an estimate, so a frame more or less.
  EXPECT_NEAR(static_cast<double>(rig.estimated()), static_cast<double>(counter("outage_ms")) / 10, 2);
  EXPECT_GE(rig.received().newest_index, last_index + 1 + rig.estimated()) << "indices tell of the outage";
}

TEST(AravisHardLife, outlasts_a_camera_that_hangs_for_two_seconds) {
  CameraProcess camera("127.0.21.3", 1);
  Rig rig(settings_for("127.0.21.3"));
  ASSERT_TRUE(streams_in_session(rig, 1, 10)) << rig.status().problem;
  camera.freeze();
  const std::int64_t thaw_ns = host_now_ns() + 2'000'000'000;
  rig.take_until([&] { return host_now_ns() >= thaw_ns; });
  camera.thaw();
  ASSERT_TRUE(streams_in_session(rig, 1, 30)) << rig.status().problem;
  camera.rest();
  EXPECT_TRUE(rig.settles_at(camera.truth().sent)) << rig.accounted() << " of " << camera.truth().sent;
  EXPECT_EQ(rig.received().wrong, 0U);
  EXPECT_EQ(rig.status().sessions, 1U) << "a hang is no reason to open it again";
}

TEST(AravisHardLife, finds_a_camera_by_its_serial_number_that_comes_back_at_another_address) {
  auto camera = std::make_unique<CameraProcess>("127.0.21.4", 1, "WANDERER");
  const CameraProcess other("127.0.21.5", 9, "NEIGHBOUR");
  Rig rig(settings_for("127.0.21.4"));
  ASSERT_TRUE(streams_in_session(rig, 1, 10)) << rig.status().problem;
  camera->kill();
  camera = std::make_unique<CameraProcess>("127.0.21.6", 2, "WANDERER");
  ASSERT_TRUE(streams_in_session(rig, 2, 10)) << rig.status().problem;
  EXPECT_NE(rig.status().device.find("WANDERER at 127.0.21.6"), std::string::npos) << rig.status().device;
  EXPECT_EQ(rig.received().wrong, 0U);
}

}  // namespace
}  // namespace rptv
