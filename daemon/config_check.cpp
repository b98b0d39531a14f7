// SPDX-License-Identifier: MIT
// The checks behind `rapidptv check`: each stage is set up as a run would, and dropped again.
#include "daemon/config_check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <memory>
#include <optional>
#include <system_error>

#include "calibration/cameras/rig.hpp"
#include "calibration/light_field/light_field_calibration.hpp"
#include "core/json.hpp"
#include "core/losses.hpp"
#include "daemon/config.hpp"
#include "daemon/first_instant.hpp"
#include "daemon/publisher.hpp"
#include "daemon/session.hpp"

namespace rptv {
namespace {

namespace fs = std::filesystem;
using Verdict = CheckResult::Verdict;

class Checks {
 public:
  Checks(const fs::path& file, const std::vector<std::string>& set) {
    check("configuration", true, [&] {
      config_ = load_config(file, set);
      return file.string();
    });
    check("calibration", config_.has_value(), [&] { return calibration(); });
    check("source", config_.has_value(), [&] { return source(); });
    check("reconstruction", calibration_ok_ && source_ != nullptr, [&] {
      std::string where;
      const auto stage = make_reconstructor(*config_, source_->cameras(), &where);
      for (std::string& line : doubts_of_first_instant(*config_)) warn("reconstruction", std::move(line));
      return fmt::format("room for {} particles a frame; {}", config_->max_particles(), where);
    });
    check("publisher", config_.has_value(), [&] { return publisher(); });
    check("output", config_.has_value(), [&] { return output(); });
  }
  std::vector<CheckResult> take() { return std::move(results_); }

 private:
  void add(const char* name, Verdict verdict, ExitCode code, std::string text) {
    results_.push_back({name, verdict, code, std::move(text)});
  }
  void warn(const char* name, std::string text) { add(name, Verdict::warning, ExitCode::ok, std::move(text)); }

  /// `look` returns what was found and may warn meanwhile.
  void check(const char* name, bool possible, const std::function<std::string()>& look) {
    if (!possible) return add(name, Verdict::skipped, ExitCode::ok, "needs what failed above");
    try {
      std::string found = look();
      const auto place = std::find_if(results_.begin(), results_.end(), [&](const auto& r) { return r.name == name; });
      results_.insert(place, {name, Verdict::ok, ExitCode::ok, std::move(found)});  // before its warnings
    } catch (const Error& error) {
      if (error.code() == ExitCode::usage) throw;
      add(name, Verdict::failed, error.code(), error.what());
    }
  }

  std::string calibration() {
    const std::string& file = config_->calibration_file();
    const bool multi_view = config_->reconstruction.is_multi_view();
    if (file.empty())
      throw Error(ExitCode::configuration, multi_view
                                               ? "'multi_view.rig' is empty; name the rig file"
                                               : "'light_field.calibration' is empty; name the calibration file");
    std::string found = multi_view ? rig(file) : light_field(file);
    calibration_ok_ = true;
    return found;
  }

  std::string light_field(const std::string& file) {
    const LightFieldCalibration camera = read_light_field_calibration(file);
    for (const auto& line : camera.warnings()) warn("calibration", line);
    return fmt::format("{}: {} x {} px, magnification {:.4g}", file, camera.sensor.width_px, camera.sensor.height_px,
                       camera.magnification());
  }

  static std::string rig(const std::string& file) {
    std::string found = file + ":";
    for (const RigCamera& camera : read_rig(file).cameras)
      found += fmt::format(" {} {} x {} px", camera.name, camera.model.intrinsics().width_px,
                           camera.model.intrinsics().height_px);
    return found;
  }

  std::string source() {
    source_ = make_source(*config_);
    if (config_->replay.speed == 0 && config_->intake.policy == "newest")
      warn("source",
           "replay.speed = 0 (as fast as possible) loses frames under intake.policy = 'newest'; take 'lossless'");
    std::string found = config_->replay.path;
    for (const auto& camera : source_->cameras())
      found += fmt::format(", {} {} x {} px {} bit", camera.name, camera.shape.width_px, camera.shape.height_px,
                           camera.significant_bits);
    make_intake_options(*config_, *source_);
    if (const std::string line = sync_warning(*config_, *source_); !line.empty()) warn("source", line);
    const std::int64_t period_ns = source_->nominal_period_ns();
    if (period_ns > 0) return found + fmt::format(", {:.6g} Hz", 1e9 / static_cast<double>(period_ns));
    return found;
  }

  /// Binding is the only proof that it can be bound; nobody has time to connect.
  std::string publisher() {
    Losses losses;
    const Publisher bound(config_->publisher, PublisherContent{}, losses, FillStatus());
    std::string found;
    for (const auto& endpoint : bound.endpoints()) found += (found.empty() ? "" : ", ") + endpoint;
    return found;
  }

  std::string output() {
    std::string found;
    for (const std::string& file : {config_->output.tracks, config_->output.points}) {
      if (file.empty()) continue;
      found += (found.empty() ? "" : ", ") + file;
      if (file != "-") writable(file);
    }
    return found.empty() ? "no files" : found;
  }

  static void writable(const fs::path& file) {
    std::error_code error;
    const fs::path folder = fs::absolute(file).parent_path();
    if (fs::is_directory(file, error)) throw Error(ExitCode::io, file.string() + ": is a folder; name a file");
    if (!fs::is_directory(folder, error))
      throw Error(ExitCode::io, file.string() + ": its folder does not exist; create it first");
    if (::access(fs::exists(file, error) ? file.c_str() : folder.c_str(), W_OK) == 0) return;
    const int reason = errno;
    throw Error(ExitCode::permission, file.string() + ": may not be written (" +
                                          std::generic_category().message(reason) + "); choose another path");
  }

  std::optional<Config> config_;
  bool calibration_ok_ = false;
  std::unique_ptr<Source> source_;
  std::vector<CheckResult> results_;
};

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::ok:
      return "ok";
    case Verdict::warning:
      return "warning";
    case Verdict::failed:
      return "failed";
    case Verdict::skipped:
      return "skipped";
  }
  return "";
}

}  // namespace

std::vector<CheckResult> check_config(const fs::path& file, const std::vector<std::string>& set) {
  return Checks(file, set).take();
}

const CheckResult* first_failure(const std::vector<CheckResult>& results) {
  const auto failed = std::find_if(results.begin(), results.end(),
                                   [](const CheckResult& result) { return result.verdict == Verdict::failed; });
  return failed == results.end() ? nullptr : &*failed;
}

std::string to_text(const std::vector<CheckResult>& results) {
  std::string text;
  for (const auto& result : results)
    text += fmt::format("{:<8} {:<15} {}\n", name_of(result.verdict), result.name, result.text);
  return text;
}

std::string to_json(const std::vector<CheckResult>& results) {
  const CheckResult* failed = first_failure(results);
  std::string list;
  for (const auto& result : results)
    list += fmt::format("{}{{\"name\": {}, \"verdict\": \"{}\", \"text\": {}}}", list.empty() ? "" : ", ",
                        json_string(result.name), name_of(result.verdict), json_string(result.text));
  return fmt::format("{{\"ok\": {}, \"exit_code\": {}, \"checks\": [{}]}}", failed == nullptr,
                     failed == nullptr ? 0 : static_cast<int>(failed->code), list);
}

}  // namespace rptv
