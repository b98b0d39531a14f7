// SPDX-License-Identifier: MIT
// Whether a run with a configuration would start: every file is opened, every stage is built, every endpoint is bound.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace rptv {

/// Outcome of one check. `text` says what was found, what is wrong (code other than ok), or what to mind.
struct CheckResult {
  enum class Verdict { ok, warning, failed, skipped };
  std::string name;  ///< configuration, calibration, source, reconstruction, publisher, output
  Verdict verdict = Verdict::ok;
  ExitCode code = ExitCode::ok;
  std::string text;
};

/// Runs all checks, those that need a failed one excepted (skipped). Takes the memory of a run and binds its endpoints
/// for a moment; writes nothing. Throws Error(usage) for a bad assignment in `set`.
std::vector<CheckResult> check_config(const std::filesystem::path& file, const std::vector<std::string>& set);

/// One line per check, aligned.
std::string to_text(const std::vector<CheckResult>& results);
/// {"ok": …, "exit_code": …, "checks": [{"name", "verdict", "text"}, …]}
std::string to_json(const std::vector<CheckResult>& results);
/// The first failure; nullptr when there is none.
const CheckResult* first_failure(const std::vector<CheckResult>& results);

}  // namespace rptv
