// SPDX-License-Identifier: MIT
// Finds controls by name, turns texts into their values, sets them and looks at what came of it.
#include "acquisition/v4l2_controls.hpp"

#include <linux/videodev2.h>

#include <cctype>
#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

#include "core/error.hpp"

namespace rptv {
namespace {

using Control = v4l2_query_ext_ctrl;

/// "White Balance, Auto" → "white_balance_auto"
std::string plain(std::string_view name) {
  std::string all;
  for (const char letter : name) {
    if (std::isalnum(static_cast<unsigned char>(letter)) != 0)
      all += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    else if (!all.empty() && all.back() != '_')
      all += '_';
  }
  if (!all.empty() && all.back() == '_') all.pop_back();
  return all;
}

std::optional<std::int64_t> number(std::string_view text) {
  const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
  if (hexadecimal) text.remove_prefix(2);
  std::int64_t value = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), value, hexadecimal ? 16 : 10);
  if (failed != std::errc{} || end != text.data() + text.size()) return {};
  return value;
}

class Controls {
 public:
  Controls(V4l2System& system, int descriptor, const std::string& path)
      : system_(system), descriptor_(descriptor), path_(path) {
    Control control{};
    control.id = V4L2_CTRL_FLAG_NEXT_CTRL;
    while (system_.call(descriptor_, VIDIOC_QUERY_EXT_CTRL, &control) == 0) {
      const bool usable = control.type != V4L2_CTRL_TYPE_CTRL_CLASS && (control.flags & V4L2_CTRL_FLAG_DISABLED) == 0U;
      if (usable) all_.push_back(control);
      control.id |= V4L2_CTRL_FLAG_NEXT_CTRL;
    }
  }

  void set(const std::string& wish, std::vector<std::string>& otherwise) {
    const std::size_t equals = wish.find('=');
    if (equals == std::string::npos)
      throw Error(ExitCode::configuration, "v4l2.controls has '" + wish + "'; write it as \"name=value\"");
    const Control control = find(plain(wish.substr(0, equals)));
    const std::string name = plain(control.name);
    if ((control.flags & V4L2_CTRL_FLAG_READ_ONLY) != 0U)
      refuse(name, "can only be read; take it out of v4l2.controls");
    const std::int64_t asked = value_of(control, name, wish.substr(equals + 1));
    v4l2_ext_control one{};
    one.id = control.id;
    if (control.type == V4L2_CTRL_TYPE_INTEGER64)
      one.value64 = asked;
    else
      one.value = static_cast<std::int32_t>(asked);
    if (!transfer(VIDIOC_S_EXT_CTRLS, one))
      throw Error(ExitCode::unavailable, path_ + ": control " + name + " cannot be set (" + std::strerror(errno) +
                                             "); set what governs it first, or take it out of v4l2.controls");
    look_at(control, name, asked, otherwise);
  }

 private:
  [[noreturn]] void refuse(const std::string& name, const std::string& why) const {
    throw Error(ExitCode::configuration, path_ + ": control " + name + " " + why);
  }

  Control find(const std::string& name) {
    std::string names;
    for (const Control& control : all_) {
      if (plain(control.name) == name) {
        Control now{};  // an earlier one of the list may have changed its flags
        now.id = control.id;
        return system_.call(descriptor_, VIDIOC_QUERY_EXT_CTRL, &now) == 0 ? now : control;
      }
      names += (names.empty() ? "" : ", ") + plain(control.name);
    }
    throw Error(ExitCode::configuration, path_ + ": has no control '" + name + "'; it has " +
                                             (names.empty() ? "none: take it out of v4l2.controls" : names));
  }

  std::int64_t value_of(const Control& control, const std::string& name, const std::string& text) {
    std::optional<std::int64_t> value = number(text);
    switch (control.type) {
      case V4L2_CTRL_TYPE_BUTTON:
        return 0;
      case V4L2_CTRL_TYPE_BOOLEAN:
        if (text == "true" || text == "on") value = 1;
        if (text == "false" || text == "off") value = 0;
        break;
      case V4L2_CTRL_TYPE_MENU:
      case V4L2_CTRL_TYPE_INTEGER_MENU:
        return entry_of(control, name, text);
      case V4L2_CTRL_TYPE_INTEGER:
      case V4L2_CTRL_TYPE_INTEGER64:
      case V4L2_CTRL_TYPE_BITMASK:
        break;
      default:
        refuse(name, "is no single number; set it with v4l2-ctl");
    }
    if (!value || *value < control.minimum || *value > control.maximum)
      refuse(name, "takes " + std::to_string(control.minimum) + " to " + std::to_string(control.maximum) +
                       (control.step > 1 ? " in steps of " + std::to_string(control.step) : "") + ", not '" + text +
                       "'");
    return *value;
  }

  std::int64_t entry_of(const Control& control, const std::string& name, const std::string& text) {
    const std::optional<std::int64_t> index = number(text);
    std::string entries;
    for (std::int64_t i = control.minimum; i <= control.maximum; ++i) {
      v4l2_querymenu entry{};
      entry.id = control.id;
      entry.index = static_cast<std::uint32_t>(i);
      if (system_.call(descriptor_, VIDIOC_QUERYMENU, &entry) < 0) continue;  // menus may have holes
      const bool numbers = control.type == V4L2_CTRL_TYPE_INTEGER_MENU;
      const std::string title = numbers ? std::to_string(entry.value) : reinterpret_cast<const char*>(entry.name);
      if (index ? *index == i : plain(title) == plain(text)) return i;
      entries += (entries.empty() ? "" : ", ") + std::to_string(i) + " (" + title + ")";
    }
    refuse(name, "has no entry '" + text + "'; it has " + entries);
  }

  void look_at(const Control& control, const std::string& name, std::int64_t asked,
               std::vector<std::string>& otherwise) {
    if (control.type == V4L2_CTRL_TYPE_BUTTON || (control.flags & V4L2_CTRL_FLAG_WRITE_ONLY) != 0U) return;
    if ((control.flags & V4L2_CTRL_FLAG_INACTIVE) != 0U)
      return otherwise.push_back("control " + name + " has no effect while an automatic one governs it");
    v4l2_ext_control one{};
    one.id = control.id;
    if (!transfer(VIDIOC_G_EXT_CTRLS, one))
      return otherwise.push_back("control " + name + " cannot be read back (" + std::strerror(errno) + ")");
    std::int64_t got = control.type == V4L2_CTRL_TYPE_INTEGER64 ? one.value64 : one.value;
    if (control.type == V4L2_CTRL_TYPE_BITMASK) got &= 0xffffffff;
    if (got != asked)
      otherwise.push_back("control " + name + " is " + std::to_string(got) + " where " + std::to_string(asked) +
                          " was asked");
  }

  bool transfer(unsigned long request, v4l2_ext_control& one) noexcept {
    v4l2_ext_controls list{};
    list.which = V4L2_CTRL_WHICH_CUR_VAL;
    list.count = 1;
    list.controls = &one;
    return system_.call(descriptor_, request, &list) == 0;
  }

  V4l2System& system_;
  const int descriptor_;
  const std::string& path_;
  std::vector<Control> all_;
};

}  // namespace

std::vector<std::string> set_v4l2_controls(V4l2System& system, int descriptor, const std::string& path,
                                           const std::vector<std::string>& wishes) {
  std::vector<std::string> otherwise;
  if (wishes.empty()) return otherwise;
  Controls controls(system, descriptor, path);
  for (const std::string& wish : wishes) controls.set(wish, otherwise);
  return otherwise;
}

}  // namespace rptv
