// SPDX-License-Identifier: MIT
// The doctor on network links: which one each camera is reached by, and whether it carries what they send together.
#include <arpa/inet.h>
#include <fmt/format.h>

#include <bit>
#include <map>
#include <optional>
#include <sstream>

#include "daemon/doctor.hpp"
#include "daemon/machine_files.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;
using Verdict = Finding::Verdict;

constexpr double kUsable = 0.94;  // of a link, after headers and gaps between packets

struct Route {
  std::string link;
  bool by_gateway = false;
};

/// The narrowest route of the kernel's main table; addresses there are in network order, as hexadecimal words.
std::optional<Route> route_to(const fs::path& root, in_addr address) {
  if ((ntohl(address.s_addr) >> 24) == 127) return Route{"lo", false};
  std::istringstream table(text_of(root / "proc/net/route"));
  std::string line;
  std::getline(table, line);  // the header
  std::optional<Route> best;
  int best_bits = -1;
  unsigned long best_metric = 0;
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string link;
    unsigned long destination = 0, gateway = 0, flags = 0, unused = 0, metric = 0, mask = 0;
    row >> link >> std::hex >> destination >> gateway >> flags >> std::dec >> unused >> unused >> metric >> std::hex >>
        mask;
    constexpr unsigned long kUp = 1, kReject = 0x200;
    if (!row || (flags & kUp) == 0 || (flags & kReject) != 0 || (address.s_addr & mask) != destination) continue;
    const int bits = std::popcount(mask);
    if (bits < best_bits || (bits == best_bits && metric >= best_metric)) continue;
    best = Route{link, gateway != 0};
    best_bits = bits;
    best_metric = metric;
  }
  return best;
}

Finding mtu(const fs::path& root, const std::string& link) {
  const long long mtu = number_of(root / "sys/class/net" / link / "mtu");
  Finding finding{"MTU of " + link, Verdict::ok, fmt::format("{}", mtu), "9000 for GigE Vision cameras", {}};
  if (mtu < 8000) finding.verdict = Verdict::warning, finding.mend = "ip link set " + link + " mtu 9000";
  return finding;
}

/// What comes over one link.
struct Load {
  std::string cameras;
  double bytes_per_second = 0;
};

Finding budget(const fs::path& root, const std::string& link, const Load& load) {
  const double needed_mbit = load.bytes_per_second * 8e-6 / kUsable;
  Finding finding{"link " + link, Verdict::ok, "loopback", {}, {}};
  finding.needed = load.bytes_per_second > 0 ? fmt::format("{:.0f} Mbit/s for {}", needed_mbit, load.cameras)
                                             : "unknown frame rate of " + load.cameras;
  if (link == "lo") return finding;
  const long long speed_mbit = number_of(root / "sys/class/net" / link / "speed");
  finding.measured = speed_mbit > 0 ? fmt::format("{} Mbit/s", speed_mbit) : "speed cannot be read";
  if (speed_mbit <= 0) {
    finding.verdict = Verdict::warning;
    finding.mend = "look whether its cable is plugged in: ethtool " + link;
  } else if (static_cast<double>(speed_mbit) < needed_mbit) {
    finding.verdict = Verdict::problem;
    finding.mend = "lower the frame rate or the region of interest, or use a faster link";
  }
  return finding;
}

}  // namespace

std::vector<Finding> examine_links(const fs::path& root, const std::vector<CameraLoad>& cameras) {
  std::vector<Finding> findings;
  std::map<std::string, Load> loads;
  for (const CameraLoad& camera : cameras) {
    in_addr address{};
    if (inet_pton(AF_INET, camera.name.c_str(), &address) != 1) continue;
    const auto route = route_to(root, address);
    if (!route || route->by_gateway)
      findings.push_back({"route to " + camera.name, route ? Verdict::warning : Verdict::problem,
                          route ? "through a gateway on " + route->link : "none", "an interface in its subnet",
                          "ip addr add <an address of its subnet> dev <the interface that it is plugged into>"});
    if (!route) continue;
    Load& load = loads[route->link];
    load.cameras += (load.cameras.empty() ? "" : ", ") + camera.name;
    load.bytes_per_second += camera.bytes_per_second;
  }
  for (const auto& [link, load] : loads) {
    if (link != "lo") findings.push_back(mtu(root, link));
    findings.push_back(budget(root, link, load));
  }
  if (!cameras.empty()) return findings;
  for (const fs::path& link : entries(root / "sys/class/net"))
    if (link.filename() != "lo" && number_of(link / "speed") > 0) findings.push_back(mtu(root, link.filename()));
  return findings;
}

}  // namespace rptv
