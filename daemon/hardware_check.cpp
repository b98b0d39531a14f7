// SPDX-License-Identifier: MIT
// The trial run of the cameras, and its words.
#include "daemon/hardware_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "acquisition/silence_alarm.hpp"
#include "core/error.hpp"
#include "core/json.hpp"
#include "daemon/session.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kLookNs = 50'000'000;

std::int64_t nanoseconds(double s) { return static_cast<std::int64_t>(s * 1e9); }

class Trial {
 public:
  Trial(const Config& config, double duration_s)
      : duration_ns_(nanoseconds(duration_s)),
        sync_(config.sync),
        source_(make_source(config)),
        intake_(source_->cameras(), options_of(config)),
        alarm_(names(), std::min(nanoseconds(config.intake.silence_alarm_s), duration_ns_ * 9 / 10)),
        first_(source_->cameras().size()) {
    if (const std::string line = sync_warning(config, *source_); !line.empty()) check_.warnings.push_back(line);
  }

  HardwareCheck run() {
    const std::int64_t start_ns = host_now_ns();
    source_->start(intake_);
    look();
    FrameSet set;
    for (std::int64_t next_look_ns = start_ns + kLookNs; host_now_ns() < start_ns + duration_ns_;) {
      if (intake_.next(set, kLookNs) == Taken::value) ++check_.sets;
      if (host_now_ns() < next_look_ns) continue;
      look();
      next_look_ns = host_now_ns() + kLookNs;
    }
    look();
    check_.elapsed_s = static_cast<double>(host_now_ns() - start_ns) * 1e-9;
    fill();
    intake_.close();
    source_->stop();
    while (intake_.next(set, kLookNs) != Taken::closed) {
    }
    judge();
    return std::move(check_);
  }

 private:
  struct Look {
    std::int64_t at_ns = 0;
    std::uint64_t delivered = 0;
  };

  /// As a run takes frames in, but for the policy: what is slow here is nobody's fault.
  IntakeOptions options_of(const Config& config) const {
    IntakeOptions options = make_intake_options(config, *source_);
    options.policy = Bounded{options.pool_frames_per_camera};
    return options;
  }
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const CameraInfo& camera : source_->cameras()) names.push_back(camera.name);
    return names;
  }

  void look() {
    const std::int64_t now_ns = host_now_ns();
    devices_ = source_->device_status();
    for (std::uint32_t c = 0; c < first_.size(); ++c) {
      last_ = {now_ns, intake_.delivered(c)};
      if (first_[c].delivered == 0) first_[c] = {now_ns, intake_.delivered(c)};
      alarm_.look(c, now_ns, intake_.delivered(c), c < devices_.size() ? &devices_[c] : nullptr);
    }
  }

  void fill() {
    for (std::uint32_t c = 0; c < first_.size(); ++c) {
      HardwareCheck::Camera camera;
      camera.report = {source_->cameras()[c].name, c < devices_.size() ? devices_[c] : DeviceStatus{},
                       intake_.delivered(c), intake_.clock_mapping(c), intake_.skew(c)};
      const std::int64_t span_ns = last_.at_ns - first_[c].at_ns;
      if (span_ns > 0)
        camera.rate_hz =
            static_cast<double>(camera.report.delivered - first_[c].delivered) * 1e9 / static_cast<double>(span_ns);
      append_losses(camera.losses, camera.report.name, intake_.losses(c));
      if (!alarm_.warning(c).empty()) check_.warnings.push_back(alarm_.warning(c));
      check_.cameras.push_back(std::move(camera));
    }
  }

  void judge() {
    for (std::uint32_t c = 0; c < first_.size() && check_.problem.empty(); ++c)
      if (check_.cameras[c].report.delivered == 0) check_.problem = alarm_.warning(c);
    doubt_tolerance();
    if (check_.problem.empty() && check_.sets == 0)
      check_.problem =
          "every camera gives frames and none of them belong together; see the losses, and choose "
          "sync.mode and sync.tolerance_us by them";
  }

  /// The period of triggered cameras is known only now.
  void doubt_tolerance() {
    double rate_hz = 0;
    for (const HardwareCheck::Camera& camera : check_.cameras) rate_hz = std::max(rate_hz, camera.rate_hz);
    const auto period_ns = rate_hz > 0 ? static_cast<std::int64_t>(1e9 / rate_hz) : 0;
    if (const std::string line = sync_.confusion(check_.cameras.size(), period_ns); !line.empty())
      check_.warnings.push_back(line);
  }

  const std::int64_t duration_ns_;
  const SyncSettings sync_;
  std::unique_ptr<Source> source_;
  Intake intake_;
  SilenceAlarm alarm_;
  std::vector<Look> first_;  // that found frames of the camera
  Look last_;
  std::vector<DeviceStatus> devices_;
  HardwareCheck check_;
};

std::string losses_of(const HardwareCheck::Camera& camera, const char* format, const char* between) {
  std::string text;
  for (const LossCount& loss : camera.losses)
    text += (text.empty() ? "" : between) + fmt::format(fmt::runtime(format), name_of(loss.cause), loss.count);
  return text;
}

}  // namespace

HardwareCheck check_hardware(const Config& config, double duration_s) {
  if (!config.source.is_live())
    throw Error(ExitCode::configuration,
                "source.kind = 'replay' has no hardware to check; leave out --hardware, or name cameras");
  return Trial(config, duration_s).run();
}

std::string to_text(const HardwareCheck& check) {
  std::string text;
  for (const HardwareCheck::Camera& camera : check.cameras) {
    text += to_line(camera.report) + fmt::format("\n  {:.2f} Hz", camera.rate_hz);
    const ClockMapping& clock = camera.report.clock;
    if (clock.valid)
      text += fmt::format(", clock {:+.6f} s and {:+.1f} ppm from the host's",
                          -1e-9 * static_cast<double>(clock.offset_ns), -clock.drift_ppm);
    const std::string lost = losses_of(camera, "{} × {}", ", ");
    text += ", lost: " + (lost.empty() ? "none" : lost) + "\n";
  }
  if (check.cameras.size() > 1) text += fmt::format("{} sets in {:.1f} s\n", check.sets, check.elapsed_s);
  for (const std::string& warning : check.warnings) text += "warning: " + warning + "\n";
  return text;
}

std::string to_json(const HardwareCheck& check) {
  std::string cameras, warnings;
  for (const HardwareCheck::Camera& camera : check.cameras)
    cameras += fmt::format(R"({}{{"camera":{},"rate_hz":{},"losses":{{{}}}}})", cameras.empty() ? "" : ",",
                           to_json(camera.report), json_number(camera.rate_hz), losses_of(camera, R"("{}":{})", ","));
  for (const std::string& warning : check.warnings) warnings += (warnings.empty() ? "" : ",") + json_string(warning);
  return fmt::format(R"({{"ok":{},"problem":{},"elapsed_s":{:.3f},"sets":{},"cameras":[{}],"warnings":[{}]}})",
                     check.problem.empty(), json_string(check.problem), check.elapsed_s, check.sets, cameras, warnings);
}

}  // namespace rptv
