// SPDX-License-Identifier: MIT
// Whether this machine is set up for cameras: what was measured, what is needed, and the command that mends it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rptv {

struct Finding {
  enum class Verdict { ok, warning, problem };
  std::string name;  ///< "net.core.rmem_max"
  Verdict verdict = Verdict::ok;
  std::string measured, needed;
  std::string mend;  ///< a command, or what else to do; empty where all is well
};

/// What a configured camera will send.
struct CameraLoad {
  std::string name;             ///< as the configuration names it; only an IPv4 address has a link that can be found
  double bytes_per_second = 0;  ///< 0: not known, and the link is then only named
};

/// Reads /sys and /proc below `root` ("/" for this machine). What cannot be read is a warning that says so. Set-up
/// only. Without cameras, all links are looked at.
std::vector<Finding> examine(const std::filesystem::path& root, const std::vector<CameraLoad>& cameras);

/// The part of it about the network: for each interface that cameras are reached by, whether it carries their images.
std::vector<Finding> examine_links(const std::filesystem::path& root, const std::vector<CameraLoad>& cameras);

/// Writes up to 256 MiB or for 2 s into a nameless file in `folder`, which is then gone, and compares the rate at which
/// the disk took it in for good. `needed_bytes_per_second` 0: not known.
Finding examine_disk(const std::filesystem::path& folder, double needed_bytes_per_second);

/// A line per finding, and one below it with the command that mends it.
std::string to_text(const std::vector<Finding>& findings);
/// {"ok": no problem, "checks": [{"name", "verdict", "measured", "needed", "mend"}, …]}
std::string to_json(const std::vector<Finding>& findings);
bool has_problem(const std::vector<Finding>& findings) noexcept;

}  // namespace rptv
