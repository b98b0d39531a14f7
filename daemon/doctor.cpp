// SPDX-License-Identifier: MIT
// The doctor's probes of /sys and /proc, and its words.
#include "daemon/doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/json.hpp"
#include "daemon/machine_files.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

constexpr long long kSocketBytes = 8'388'608;  // a burst of some images while the receiving thread does not run
constexpr long long kUsbMegabytes = 1000;      // USB3 cameras with 16 buffers each
constexpr unsigned kNetRaw = 13;               // CAP_NET_RAW in linux/capability.h

Finding at_least(const std::string& name, const fs::path& file, long long needed, const std::string& mend) {
  const long long value = number_of(file);
  Finding finding{name, Verdict::ok, fmt::format("{}", value), fmt::format("{} or more", needed), {}};
  if (value < 0) finding.measured = "cannot be read";
  if (value < needed) finding.verdict = Verdict::warning, finding.mend = mend;
  return finding;
}

Finding limit(const fs::path& root, const std::string& row, const std::string& name, long long needed,
              const std::string& needed_text, const std::string& mend) {
  const std::string text = text_of(root / "proc/self/limits");
  Finding finding{name, Verdict::ok, "cannot be read", needed_text, {}};
  const auto at = text.find(row);
  long long value = -1;
  if (at != std::string::npos) {
    const std::string soft = text.substr(text.find_first_not_of(' ', at + row.size()), 24);
    finding.measured = soft.substr(0, soft.find(' '));
    value = finding.measured == "unlimited" ? needed : std::atoll(finding.measured.c_str());
  }
  if (value < needed) finding.verdict = Verdict::warning, finding.mend = mend;
  return finding;
}

Finding governor(const fs::path& root) {
  const std::string now = text_of(root / "sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
  Finding finding{"CPU governor", Verdict::ok, now.empty() ? "none: the clock is fixed" : now, "performance", {}};
  if (!now.empty() && now != "performance") {
    finding.verdict = Verdict::warning;
    finding.mend = "echo performance | tee /sys/devices/system/cpu/cpu*/cpufreq/scaling_governor";
  }
  return finding;
}

Finding packet_socket(const fs::path& root) {
  const std::string status = text_of(root / "proc/self/status");
  const auto at = status.find("CapEff:");
  const auto mask = at == std::string::npos ? 0 : std::strtoull(status.c_str() + at + 7, nullptr, 16);
  if ((mask >> kNetRaw & 1U) != 0) return {"packet socket", Verdict::ok, "CAP_NET_RAW held", "CAP_NET_RAW", {}};
  return {"packet socket", Verdict::warning, "CAP_NET_RAW missing", "CAP_NET_RAW",
          "setcap cap_net_raw+ep $(command -v rapidptv), or AmbientCapabilities=CAP_NET_RAW in the unit"};
}

Finding ptp(const fs::path& root) {
  const auto clocks = entries(root / "sys/class/ptp").size();
  if (clocks > 0) return {"PTP clocks", Verdict::ok, fmt::format("{}", clocks), "1 or more for PTP cameras", {}};
  return {"PTP clocks", Verdict::warning, "0", "1 or more for PTP cameras",
          "use a network card with hardware time stamps, or ptp4l -S -i <interface>"};
}

std::string_view word(Verdict verdict) {
  if (verdict == Verdict::ok) return "ok";
  return verdict == Verdict::warning ? "warning" : "problem";
}

}  // namespace

std::vector<Finding> examine(const fs::path& root, const std::vector<CameraLoad>& cameras) {
  std::vector<Finding> findings = examine_links(root, cameras);
  findings.push_back(at_least("net.core.rmem_max", root / "proc/sys/net/core/rmem_max", kSocketBytes,
                              fmt::format("sysctl -w net.core.rmem_max={}", kSocketBytes)));
  const fs::path usb = root / "sys/module/usbcore/parameters/usbfs_memory_mb";
  if (fs::exists(usb))
    findings.push_back(
        at_least("usbfs_memory_mb", usb, kUsbMegabytes,
                 fmt::format("echo {} > /sys/module/usbcore/parameters/usbfs_memory_mb", kUsbMegabytes)));
  findings.push_back(limit(root, "Max realtime priority", "rtprio", 50, "50 or more",
                           "LimitRTPRIO=50 in the unit, or `- rtprio 50` in /etc/security/limits.d/rapidptv.conf"));
  findings.push_back(limit(root, "Max locked memory", "memlock", 1LL << 30, "unlimited, or all frame pools",
                           "LimitMEMLOCK=infinity in the unit, or `- memlock unlimited` in "
                           "/etc/security/limits.d/rapidptv.conf"));
  findings.push_back(governor(root));
  findings.push_back(packet_socket(root));
  findings.push_back(ptp(root));
  return findings;
}

std::string to_text(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) {
    text += fmt::format("{:<8} {:<20} {} (needed: {})\n", word(f.verdict), f.name, f.measured, f.needed);
    if (!f.mend.empty()) text += fmt::format("{:<8} {:<20} mend: {}\n", "", "", f.mend);
  }
  return text;
}

std::string to_json(const std::vector<Finding>& findings) {
  std::string list;
  for (const Finding& f : findings)
    list += fmt::format(R"({}{{"name": {}, "verdict": "{}", "measured": {}, "needed": {}, "mend": {}}})",
                        list.empty() ? "" : ", ", json_string(f.name), word(f.verdict), json_string(f.measured),
                        json_string(f.needed), json_string(f.mend));
  return fmt::format(R"({{"ok": {}, "checks": [{}]}})", !has_problem(findings), list);
}

bool has_problem(const std::vector<Finding>& findings) noexcept {
  return std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.verdict == Verdict::problem; });
}

}  // namespace rptv
