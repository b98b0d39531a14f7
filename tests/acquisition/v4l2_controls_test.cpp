// SPDX-License-Identifier: MIT
// Controls by name over a driver of ours: what is set, what is refused with which words, what is told.
#include "acquisition/v4l2_controls.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>

#include "core/error.hpp"

namespace rptv {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

v4l2_query_ext_ctrl control(std::uint32_t id, const char* name, std::uint32_t type, std::int64_t minimum,
                            std::int64_t maximum, std::uint64_t step = 1, std::uint32_t flags = 0) {
  v4l2_query_ext_ctrl made{};
  made.id = id, made.type = type, made.minimum = minimum, made.maximum = maximum, made.step = step, made.flags = flags;
  std::strncpy(made.name, name, sizeof made.name - 1);
  return made;
}

// Rounds the exposure to its steps, as many cameras do, and interrupts each call once.
class Driver : public V4l2System {
 public:
  const std::vector<v4l2_query_ext_ctrl> controls = {
      control(1, "Camera Controls", V4L2_CTRL_TYPE_CTRL_CLASS, 0, 0),
      control(2, "Auto Exposure", V4L2_CTRL_TYPE_MENU, 0, 3),
      control(3, "Exposure Time, Absolute", V4L2_CTRL_TYPE_INTEGER, 3, 2047, 4),
      control(4, "LED1 Frequency", V4L2_CTRL_TYPE_INTEGER64, 0, INT64_MAX),
      control(5, "Gain", V4L2_CTRL_TYPE_INTEGER, 0, 255, 1, V4L2_CTRL_FLAG_INACTIVE),
      control(6, "Temperature", V4L2_CTRL_TYPE_INTEGER, 0, 100, 1, V4L2_CTRL_FLAG_READ_ONLY),
      control(7, "Trigger", V4L2_CTRL_TYPE_BUTTON, 0, 0, 0, V4L2_CTRL_FLAG_WRITE_ONLY),
      control(8, "Horizontal Flip", V4L2_CTRL_TYPE_BOOLEAN, 0, 1),
      control(9, "Link Frequency", V4L2_CTRL_TYPE_INTEGER_MENU, 0, 1),
      control(10, "Lookup Table", V4L2_CTRL_TYPE_U8, 0, 255),
      control(11, "Outputs", V4L2_CTRL_TYPE_BITMASK, 0, 0x80000003, 0)};
  std::map<std::uint32_t, std::int64_t> values;
  std::vector<std::uint32_t> order;
  int refusal = 0;  // errno of setting

  int ioctl(int, unsigned long request, void* argument) noexcept override {
    interrupted_ = !interrupted_;
    if (interrupted_) return errno = EINTR, -1;
    if (request == VIDIOC_QUERY_EXT_CTRL) return query(*static_cast<v4l2_query_ext_ctrl*>(argument));
    if (request == VIDIOC_QUERYMENU) return menu(*static_cast<v4l2_querymenu*>(argument));
    v4l2_ext_control& one = *static_cast<v4l2_ext_controls*>(argument)->controls;
    if (request == VIDIOC_S_EXT_CTRLS) {
      if (refusal != 0) return errno = refusal, -1;
      order.push_back(one.id);
      values[one.id] = one.id == 4 ? one.value64 : one.value;
      if (one.id == 3) values[3] = 3 + (one.value - 3) / 4 * 4;
    } else if (one.id == 4) {
      one.value64 = values[4];
    } else {
      one.value = static_cast<std::int32_t>(values[one.id]);
    }
    return 0;
  }

 private:
  int query(v4l2_query_ext_ctrl& asked) noexcept {
    const bool next = (asked.id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
    const std::uint32_t id = asked.id & ~V4L2_CTRL_FLAG_NEXT_CTRL;
    for (const auto& one : controls)
      if (next ? one.id > id : one.id == id) return asked = one, 0;
    return errno = EINVAL, -1;
  }
  static int menu(v4l2_querymenu& entry) noexcept {
    const char* const names[] = {"Auto Mode", "Manual Mode", "", "Aperture Priority Mode"};
    if (entry.id == 2 && entry.index == 2) return errno = EINVAL, -1;  // a hole
    if (entry.id == 9)
      entry.value = entry.index == 0 ? 148'500'000 : 297'000'000;
    else
      std::strncpy(reinterpret_cast<char*>(entry.name), names[entry.index], sizeof entry.name);
    return 0;
  }
  bool interrupted_ = false;
};

std::vector<std::string> set(Driver& driver, const std::vector<std::string>& wishes) {
  return set_v4l2_controls(driver, 77, "/dev/video9", wishes);
}

TEST(V4l2Controls, are_set_by_name_in_their_order) {
  Driver driver;
  EXPECT_THAT(set(driver, {"exposure_time_absolute=103", "auto_exposure=1", "led1_frequency=5000000000", "trigger=1",
                           "Horizontal Flip=true", "link_frequency=1", "outputs=0x80000001"}),
              IsEmpty());
  EXPECT_THAT(driver.order, ElementsAre(3, 2, 4, 7, 8, 9, 11));
  EXPECT_EQ(driver.values[3], 103);
  EXPECT_EQ(driver.values[2], 1);
  EXPECT_EQ(driver.values[4], 5'000'000'000);
  EXPECT_EQ(driver.values[8], 1);
  EXPECT_EQ(driver.values[9], 1);
}

TEST(V4l2Controls, take_the_text_of_a_menus_entry) {
  Driver driver;
  EXPECT_THAT(set(driver, {"auto_exposure=Aperture Priority Mode"}), IsEmpty());
  EXPECT_EQ(driver.values[2], 3);
  EXPECT_THAT(set(driver, {"auto_exposure=manual_mode"}), IsEmpty());
  EXPECT_EQ(driver.values[2], 1);
}

TEST(V4l2Controls, tell_what_the_driver_made_of_a_value) {
  Driver driver;
  EXPECT_THAT(set(driver, {"exposure_time_absolute=105", "gain=7"}),
              ElementsAre("control exposure_time_absolute is 103 where 105 was asked",
                          "control gain has no effect while an automatic one governs it"));
}

TEST(V4l2Controls, say_what_there_is_when_they_refuse) {
  Driver driver;
  const std::pair<const char*, const char*> cases[] = {
      {"exposure=1",
       "/dev/video9: has no control 'exposure'; it has auto_exposure, exposure_time_absolute, led1_frequ"},
      {"gain", "v4l2.controls has 'gain'; write it as \"name=value\""},
      {"gain=256", "control gain takes 0 to 255, not '256'"},
      {"gain=4.5", "control gain takes 0 to 255, not '4.5'"},
      {"exposure_time_absolute=2", "takes 3 to 2047 in steps of 4, not '2'"},
      {"auto_exposure=2", "has no entry '2'; it has 0 (Auto Mode), 1 (Manual Mode), 3 (Aperture Priority Mode)"},
      {"auto_exposure=none", "has no entry 'none'"},
      {"link_frequency=2", "it has 0 (148500000), 1 (297000000)"},
      {"temperature=20", "can only be read"},
      {"lookup_table=1", "is no single number"},
      {"camera_controls=1", "has no control"}};
  for (const auto& one : cases) {
    const auto wish = [&] { set(driver, {one.first}); };
    EXPECT_THAT(wish, testing::ThrowsMessage<Error>(HasSubstr(one.second))) << one.first;
  }
  EXPECT_THAT(driver.order, IsEmpty());
  driver.refusal = EBUSY;
  EXPECT_THAT([&] { set(driver, {"gain=1"}); },
              testing::ThrowsMessage<Error>(HasSubstr("gain cannot be set (Device or resource busy)")));
}

}  // namespace
}  // namespace rptv
