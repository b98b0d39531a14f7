// SPDX-License-Identifier: MIT
// SilenceAlarm: one line per episode, with the cause that the device's state points to.
#include "acquisition/silence_alarm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rptv {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kSecondNs = 1'000'000'000;

TEST(SilenceAlarm, speaks_once_when_silence_begins_and_once_when_it_ends) {
  SilenceAlarm alarm({"left", "right"}, 2 * kSecondNs);
  for (const std::uint32_t camera : {0U, 1U}) EXPECT_THAT(alarm.look(camera, kSecondNs, 5, nullptr), IsEmpty());
  EXPECT_THAT(alarm.look(1, 2 * kSecondNs, 5, nullptr), IsEmpty());
  EXPECT_THAT(alarm.look(0, 3 * kSecondNs, 6, nullptr), IsEmpty());
  EXPECT_THAT(alarm.look(1, 3 * kSecondNs, 5, nullptr), HasSubstr("right: no frame for 2.0 s"));
  EXPECT_THAT(alarm.look(1, 4 * kSecondNs, 5, nullptr), IsEmpty());
  EXPECT_THAT(alarm.warning(1), HasSubstr("no frame for 3.0 s"));
  EXPECT_THAT(alarm.warning(0), IsEmpty());
  EXPECT_THAT(alarm.look(1, 5 * kSecondNs, 6, nullptr), HasSubstr("right: frames come again after 4.0 s"));
  EXPECT_THAT(alarm.warning(1), IsEmpty());
  EXPECT_THAT(alarm.look(1, 7 * kSecondNs, 6, nullptr), HasSubstr("no frame"));
}

std::string cause(const DeviceStatus& before, const DeviceStatus& after, std::uint64_t delivered) {
  SilenceAlarm alarm({"left"}, kSecondNs);
  alarm.look(0, 0, delivered, &before);
  return alarm.look(0, kSecondNs, delivered, &after);
}

TEST(SilenceAlarm, names_the_cause_that_the_device_points_to) {
  DeviceStatus calm;
  calm.state = DeviceState::streaming;
  calm.counters = {{"n_missing_packets", 3}};
  EXPECT_THAT(cause(calm, calm, 0), HasSubstr("wrong network interface"));
  EXPECT_THAT(cause(calm, calm, 9), HasSubstr("sends nothing"));
  DeviceStatus losing = calm;
  losing.counters[0].count = 4;
  EXPECT_THAT(cause(calm, losing, 9), HasSubstr("missing packets"));
  DeviceStatus triggered = calm;
  triggered.link = "Mono8, trigger Line1";
  EXPECT_THAT(cause(triggered, triggered, 0), HasSubstr("trigger is configured"));
  DeviceStatus fired = calm;
  fired.link = "Mono8, trigger software";
  EXPECT_THAT(cause(fired, fired, 0), HasSubstr("rate_hz"));
  DeviceStatus lost = triggered;
  lost.state = DeviceState::lost;
  EXPECT_THAT(cause(triggered, lost, 9), HasSubstr("device is lost"));
  lost.problem = "10.0.0.2 does not answer; plug it in";
  EXPECT_THAT(cause(triggered, lost, 9), HasSubstr(lost.problem));
}

}  // namespace
}  // namespace rptv
