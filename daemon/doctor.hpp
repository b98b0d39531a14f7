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

/// What the configured cameras will send; 0: not known, and the link is then only named.
struct CameraLoad {
  double bytes_per_second = 0;
};

/// Reads /sys and /proc below `root` ("/" for this machine). What cannot be read is a warning that says so. Set-up
/// only.
std::vector<Finding> examine(const std::filesystem::path& root, const CameraLoad& load);

/// A line per finding, and one below it with the command that mends it.
std::string to_text(const std::vector<Finding>& findings);
/// {"ok": no problem, "checks": [{"name", "verdict", "measured", "needed", "mend"}, …]}
std::string to_json(const std::vector<Finding>& findings);
bool has_problem(const std::vector<Finding>& findings) noexcept;

}  // namespace rptv
