// SPDX-License-Identifier: MIT
// DeviceClock against clocks whose truth is known: random drift, heavy-tailed delays, jumps.
#include "acquisition/device_clock.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace rptv {
namespace {

constexpr std::int64_t kFloorNs = 200'000;  // the delay that every frame has

// A device whose clock runs at 1 + ppm of the host's, and frames that arrive late: mostly 0.1 ms, now and then 100 ms.
struct Device {
  double ppm = 0;
  std::int64_t first_device_ns = 0;
  std::mt19937_64 random{1};
  std::int64_t device_ns(std::int64_t host_ns) const {
    return first_device_ns + host_ns + std::llround(static_cast<double>(host_ns) * ppm * 1e-6);
  }
  std::int64_t delay_ns() {
    const double u = std::uniform_real_distribution<>(1e-4, 1)(random);
    return kFloorNs + std::llround(std::min(100e6, 30e3 / u));
  }
};

RC_GTEST_PROP(DeviceClock, finds_offset_and_drift_below_heavy_tailed_delays, ()) {
  Device device{static_cast<double>(*rc::gen::inRange(-200, 201)),
                *rc::gen::inRange<std::int64_t>(-1'000'000'000, 1LL << 60),
                std::mt19937_64(*rc::gen::arbitrary<std::uint64_t>())};
  const std::int64_t period_ns = 1'000'000'000 / *rc::gen::inRange(20, 501);
  DeviceClock clock;
  std::int64_t last_ns = 0, last_arrival_ns = 0;
  for (std::int64_t host_ns = 5'000'000'000; host_ns < 35'000'000'000; host_ns += period_ns) {
    const std::int64_t arrival_ns = std::max(last_arrival_ns, host_ns + device.delay_ns());
    last_arrival_ns = arrival_ns;
    const std::int64_t mapped_ns = clock.map(device.device_ns(host_ns), arrival_ns);
    RC_ASSERT(mapped_ns >= last_ns);
    RC_ASSERT(mapped_ns <= arrival_ns);
    last_ns = mapped_ns;
    if (host_ns < 20'000'000'000) continue;
    const std::int64_t error_ns = mapped_ns - host_ns - kFloorNs;
    RC_ASSERT(std::abs(error_ns) < 200'000);
  }
  RC_ASSERT(std::abs(clock.mapping().drift_ppm + device.ppm) < 15.0);
  RC_ASSERT(clock.mapping().restarts == 0U);
}

std::int64_t play(DeviceClock& clock, Device& device, std::int64_t from_ns, std::int64_t to_ns) {
  std::int64_t error_ns = 0;
  for (std::int64_t host_ns = from_ns; host_ns < to_ns; host_ns += 10'000'000)
    error_ns = clock.map(device.device_ns(host_ns), host_ns + kFloorNs) - host_ns - kFloorNs;
  return error_ns;
}

/// Five seconds, then the device's clock reads `then_ns` at host time 0, and frames come again from `from_ns` on.
void expect_one_new_fit(Device device, std::int64_t then_ns, std::int64_t from_ns) {
  DeviceClock clock;
  EXPECT_LT(std::abs(play(clock, device, 0, 5'000'000'000)), 10'000);
  device.first_device_ns = then_ns;
  EXPECT_LT(std::abs(play(clock, device, from_ns, from_ns + 5'000'000'000)), 10'000);
  EXPECT_EQ(clock.mapping().restarts, 1U);
}

TEST(DeviceClock, begins_anew_when_the_device_starts_at_zero_again) {
  expect_one_new_fit({50, 1'000'000'000'000}, -8'000'000'000, 8'000'000'000);
}

TEST(DeviceClock, begins_anew_when_the_device_jumps_ahead) {
  expect_one_new_fit({-80, 0}, 60'000'000'000, 5'000'000'000);
}

TEST(DeviceClock, begins_anew_when_the_device_has_stood_still) {
  expect_one_new_fit({0, 0}, -3'000'000'000, 8'000'000'000);  // it goes on where it stopped, three seconds later
}

TEST(DeviceClock, takes_a_lone_late_frame_for_what_it_is) {
  DeviceClock clock;
  Device device{0, 0};
  play(clock, device, 0, 5'000'000'000);
  EXPECT_EQ(clock.map(5'000'000'000, 5'900'000'000), 5'000'000'000 + kFloorNs);
  EXPECT_EQ(clock.mapping().restarts, 0U);
}

TEST(DeviceClock, survives_any_number_that_a_device_may_send) {
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  DeviceClock clock;
  std::int64_t arrival_ns = 1'000'000;
  std::int64_t last_ns = 0;
  for (const std::int64_t device_ns : {kMost, kLeast, std::int64_t{0}, kMost, std::int64_t{-1}, kLeast, kMost}) {
    const std::int64_t mapped_ns = clock.map(device_ns, arrival_ns += 1000);
    EXPECT_LE(mapped_ns, arrival_ns);
    EXPECT_GE(mapped_ns, last_ns);
    last_ns = mapped_ns;
  }
}

}  // namespace
}  // namespace rptv
