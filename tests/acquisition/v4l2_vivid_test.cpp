// SPDX-License-Identifier: MIT
// V4L2 cameras over a real kernel driver: formats, losses, faults and devices that go away. Runs in the emulated
// machine.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "acquisition/found_camera.hpp"
#include "core/error.hpp"
#include "tests/acquisition/vivid_card.hpp"
#include "tests/core/allocation_counter.hpp"

namespace rptv {
namespace {

using testing::HasSubstr;

// Stops the session. Every image that the driver gave is somewhere, and every index is.
void expect_accounted_for(VividSession& session) {
  session.stop();
  const std::vector<std::uint64_t>& seen = session.indices();
  ASSERT_FALSE(seen.empty());
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end(), std::less_equal<>()));
  const std::uint64_t over_bound = session.lost(LossCause::over_bound);
  // On a loaded machine this driver gives a sequence number twice now and then.
  EXPECT_EQ(session.counter("dequeued"), seen.size() + session.counter("torn") + session.counter("no_slot") +
                                             over_bound + session.lost(LossCause::source_duplicate) +
                                             session.lost(LossCause::after_close));
  const std::uint64_t lost = session.lost(LossCause::source_gap) + session.lost(LossCause::source_outage) +
                             session.lost(LossCause::source_torn) + session.lost(LossCause::pool_empty) + over_bound;
  EXPECT_GE(lost, seen.back() - seen.front() + 1 - seen.size());
}

// Grey values of the third image.
std::vector<std::uint32_t> picture(const std::string& format) {
  VividSession session(webcam(format));
  std::vector<std::uint32_t> values;
  std::int64_t last_ns = 0;
  for (int i = 0; i < 3; ++i) {
    const FrameSet set = session.next();
    if (set.cameras == 0) return {};
    const ImageView view = set.frames[0].view();
    values.resize(view.shape.pixels());
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = grey_at(view, k);
    EXPECT_EQ(set.info().clock, ClockId::host_monotonic);
    EXPECT_GT(set.info().exposure_end_ns, last_ns);
    EXPECT_LT(std::abs(set.info().exposure_end_ns - set.info().arrival_ns), 10'000'000'000);  // it is this clock
    last_ns = set.info().exposure_end_ns;
  }
  expect_accounted_for(session);
  return values;
}

TEST(V4l2Vivid, gives_the_same_picture_in_every_format) {
  press("osd_text_mode=none", kCapture);
  const std::vector<std::uint32_t> grey = picture("GREY");
  ASSERT_EQ(grey.size(), 320U * 180U);
  EXPECT_NE(*std::max_element(grey.begin(), grey.end()), *std::min_element(grey.begin(), grey.end()));
  const std::pair<const char*, unsigned> wider[] = {{"Y10", 2}, {"Y12", 4}, {"Y16", 8}};
  for (const auto& [format, shift] : wider) {
    std::vector<std::uint32_t> image = picture(format);
    for (std::uint32_t& value : image) value >>= shift;
    EXPECT_EQ(image, grey) << format;
  }
  const std::vector<std::uint32_t> yuyv = picture("YUYV");
  EXPECT_EQ(picture("NV12"), yuyv);
  EXPECT_EQ(yuyv.size(), grey.size());
}

TEST(V4l2Vivid, takes_no_exposure_to_have_ended_after_its_image_came) {
  press("timestamp_source=end_of_frame", kCapture);  // stamps with the end that it expects
  VividSession session(webcam());
  for (int i = 0; i < 5; ++i) {
    const FrameInfo info = session.next().info();
    EXPECT_EQ(info.exposure_end_host_ns, std::min(info.exposure_end_ns, info.arrival_ns));
  }
}

TEST(V4l2Vivid, counts_the_buffers_that_the_driver_drops) {
  VividSession session(webcam());
  press("percentage_of_dropped_buffers=30");
  EXPECT_TRUE(session.take_until([&] { return session.lost(LossCause::source_gap) >= 5; }));
  press("percentage_of_dropped_buffers=0");
  expect_accounted_for(session);
  EXPECT_EQ(session.counter("sequence_gaps"), session.lost(LossCause::source_gap));
}

TEST(V4l2Vivid, counts_an_image_that_the_driver_calls_bad) {
  VividSession session(webcam());
  EXPECT_TRUE(session.take(2));
  press("inject_v4l2_buf_flag_error=1");
  EXPECT_TRUE(session.take_until([&] { return session.lost(LossCause::source_torn) == 1; }));
  EXPECT_TRUE(session.take(2));
  EXPECT_EQ(session.counter("torn"), 1U);
  EXPECT_EQ(session.status().sessions, 1U);
  expect_accounted_for(session);
}

TEST(V4l2Vivid, opens_the_device_again_after_each_of_its_faults) {
  VividSession session(webcam());
  EXPECT_TRUE(session.take(2));
  std::uint64_t sessions = 1;
  // EINVAL of QBUF; EIO of DQBUF; ENODEV, after which it is there again when all have closed it.
  for (const char* fault : {"inject_vidioc_qbuf_error=1", "inject_fatal_streaming_error=1", "disconnect=1"}) {
    press(fault);
    ++sessions;
    EXPECT_TRUE(session.take_until([&] { return session.status().sessions == sessions; })) << fault;
    EXPECT_TRUE(session.take(2)) << fault;
    EXPECT_EQ(session.status().state, DeviceState::streaming) << session.status().problem;
  }
  EXPECT_EQ(session.counter("device_lost"), 3U);
  expect_accounted_for(session);
}

TEST(V4l2Vivid, survives_unplugging_and_plugging_in) {
  VividSession session(webcam());
  EXPECT_TRUE(session.take(2));
  std::ofstream("/sys/bus/platform/drivers/vivid/unbind") << "vivid.0" << std::flush;
  EXPECT_TRUE(VividSession::wait_for([&] { return session.status().state == DeviceState::lost; }));
  EXPECT_THAT(session.status().problem, HasSubstr(kCapture));
  EXPECT_NE(access(kCapture, F_OK), 0);
  std::ofstream("/sys/bus/platform/drivers/vivid/bind") << "vivid.0" << std::flush;
  EXPECT_TRUE(session.take(5));
  EXPECT_EQ(session.status().sessions, 2U);
  EXPECT_GE(session.counter("plug_events"), 1U);
  expect_accounted_for(session);
}

TEST(V4l2Vivid, goes_on_over_the_wrap_of_the_sequence_number) {
  press("wrap_sequence_number=1");
  VividSession session(webcam());
  EXPECT_TRUE(session.take_until([&] { return !session.indices().empty() && session.indices().back() > UINT32_MAX; }));
  press("wrap_sequence_number=0");
  EXPECT_EQ(session.counter("sequence_steps_back"), 0U);
  expect_accounted_for(session);
}

TEST(V4l2Vivid, refuses_what_the_driver_would_silently_change_and_says_what_it_has) {
  V4l2Settings odd = webcam();
  odd.width_px = 321;
  EXPECT_THAT([&] { V4l2Source source(odd, 16); },
              testing::ThrowsMessage<Error>(testing::AllOf(HasSubstr("gives 320 x 180 px where 321 x 180 was asked"),
                                                           HasSubstr(": 320 x 180, 640 x 360, 640 x 480, "))));
  V4l2Settings fast = webcam();
  fast.rate_hz = 1000;
  EXPECT_THAT([&] { V4l2Source source(fast, 16); },
              testing::ThrowsMessage<Error>(testing::AllOf(HasSubstr("where v4l2.rate_hz = 1000"),
                                                           HasSubstr("or 0: 1, 2, "), testing::EndsWith(", 60 Hz"))));
}

TEST(V4l2Vivid, tells_the_clock_of_its_stamps) {
  for (const char* memory : {"mmap", "userptr"}) {
    V4l2Settings settings = webcam();
    settings.memory = memory;
    press("timestamp_source=start_of_exposure", kCapture);
    EXPECT_THAT(VividSession(settings).status().link, HasSubstr("stamps of CLOCK_MONOTONIC at the start of exposure"));
    press("timestamp_source=end_of_frame", kCapture);
    EXPECT_THAT(VividSession(settings).status().link, HasSubstr("stamps of CLOCK_MONOTONIC at the end of the image"));
  }
}

TEST(V4l2Vivid, keeps_every_slot_in_the_cycle_over_faults_and_full_queues) {
  V4l2Settings settings = webcam();
  settings.memory = "userptr";
  VividSession session(settings);
  EXPECT_TRUE(session.take(2));
  {
    std::vector<FrameSet> kept;  // until no slot is left for the driver's images
    while (kept.size() + static_cast<std::size_t>(settings.buffers) < VividSession::kPoolFrames)
      kept.push_back(session.next());
    EXPECT_TRUE(VividSession::wait_for([&] { return session.lost(LossCause::pool_empty) > 0; }));
  }
  press("inject_fatal_streaming_error=1");
  EXPECT_TRUE(session.take_until([&] { return session.status().sessions == 2; }));
  EXPECT_TRUE(session.take(30));
  expect_accounted_for(session);
  EXPECT_EQ(session.free_slots(), VividSession::kPoolFrames);
}

TEST(V4l2Vivid, allocates_nothing_while_frames_come) {
  if (!AllocationCounter::kCounts) GTEST_SKIP() << "a sanitizer has replaced malloc";
  for (const char* memory : {"mmap", "userptr"}) {
    V4l2Settings settings = webcam();
    settings.memory = memory;
    VividSession session(settings);
    EXPECT_TRUE(session.take(2));
    AllocationCounter counter;
    for (int i = 0; i < 20; ++i) session.next();
    EXPECT_EQ(counter.disarm(), 0U) << memory;
  }
}

TEST(V4l2Vivid, refuses_slots_for_formats_that_must_be_unpacked) {
  for (const char* format : {"YUYV", "NV12"}) {
    V4l2Settings settings = webcam(format);
    settings.memory = "userptr";
    EXPECT_THAT([&] { VividSession session(settings); },
                testing::ThrowsMessage<Error>(HasSubstr("'userptr' (Operation not supported); set it to 'auto'")));
  }
}

TEST(V4l2Vivid, is_listed_with_its_formats) {
  V4l2System system;
  const std::vector<FoundCamera> found = find_v4l2_cameras(system);
  ASSERT_EQ(found.size(), 1U);  // its output node is no camera
  EXPECT_EQ(found[0].address, kCapture);
  EXPECT_EQ(found[0].model, "vivid");
  EXPECT_THAT(found[0].formats, testing::IsSupersetOf({"GREY", "Y10", "Y12", "Y16", "YUYV", "NV12"}));
  EXPECT_EQ(std::count(found[0].formats.begin(), found[0].formats.end(), "Y16"), 1);
  EXPECT_THAT(found[0].formats, testing::Contains("Y16-BE"));
}

}  // namespace
}  // namespace rptv
