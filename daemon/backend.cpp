// SPDX-License-Identifier: MIT
// "auto" falls back to the CPU and says why; "cuda" is an error where it cannot be had.
#include "daemon/backend.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "reconstruct/detection/detect_cuda.hpp"
#include "reconstruct/light_field/light_field_cuda.hpp"
#include "reconstruct/multi_view/match_cuda.hpp"
#include "reconstruct/parallel.hpp"

namespace rptv {

namespace {

/// Why this configuration cannot use a device; empty: it can.
std::string obstacle(const Config& config, const CudaProbe& probe) {
  if (!probe.usable) return probe.text;
  if (config.reconstruction.is_multi_view()) {
    if (config.multi_view.method != "detections")
      return fmt::format("multi_view.method = \"{}\" runs on the CPU only; the device does \"detections\"",
                         config.multi_view.method);
    const std::string setting = only_on_cpu(config.multi_view.detector);
    return setting.empty() ? setting : "the device does not do multi_view." + setting;
  }
  if (config.light_field.counting != "coarse_to_fine")
    return fmt::format("light_field.counting = \"{}\" runs on the CPU only; the device does \"coarse_to_fine\"",
                       config.light_field.counting);
  return {};
}

Backend on_the_cpu(const std::string& reason) { return {false, "reconstructing on the CPU: " + reason}; }

const CudaProbe& this_machine() {
  static const CudaProbe probe = probe_cuda();
  return probe;
}

}  // namespace

std::string device_failure(std::uint64_t sets_without_device) {
  return fmt::format(
      "the GPU failed; the CPU has done {} frame sets alone since, by the same rules: see nvidia-smi and the kernel's "
      "log, then start again",
      sets_without_device);
}

Backend choose_backend(const Config& config, const CudaProbe& probe) {
  const std::string& wanted = config.reconstruction.backend;
  if (wanted == "cpu") return {false, "reconstructing on the CPU"};
  const std::string why_not = obstacle(config, probe);
  if (why_not.empty()) return {true, "reconstructing on " + probe.text};
  if (wanted == "auto") return on_the_cpu(why_not);
  throw Error(ExitCode::unavailable,
              "reconstruction.backend = \"cuda\": " + why_not + "; \"auto\" and \"cpu\" do without");
}

Backend choose_backend(const Config& config) {
  return choose_backend(config, config.reconstruction.backend == "cpu" ? CudaProbe{} : this_machine());
}

Backend judge(const Config& config, const std::string& device, const DeviceTrial& trial, const std::string& work) {
  const bool must = config.reconstruction.backend == "cuda";
  if (!trial.differs.empty()) {
    const std::string wrong = fmt::format(
        "{} does not repeat what the CPU makes of a test image: {}; report this with the output of nvidia-smi", device,
        trial.differs);
    if (!must) return on_the_cpu(wrong);
    throw Error(ExitCode::unavailable, "reconstruction.backend = \"cuda\": " + wrong);
  }
  if (must || trial.device_ms < trial.cpu_ms)
    return {true, fmt::format("reconstructing on {}: {:.2f} ms to {}, the CPU takes {:.2f}", device, trial.device_ms,
                              work, trial.cpu_ms)};
  return on_the_cpu(fmt::format("{:.2f} ms to {}, {} takes {:.2f}", trial.cpu_ms, work, device, trial.device_ms));
}

namespace {

/// make() and test() what was made; null, with the reason in `backend`, where it is not to be used.
template <class Make, class Test>
auto make_tried(const Config& config, Backend& backend, const std::string& work, const Make& make, const Test& test)
    -> decltype(make()) {
  if (!backend.device) return nullptr;
  try {
    auto device = make();
    backend = judge(config, this_machine().text, test(*device), work);
    if (backend.device) return device;
  } catch (const Error& error) {
    if (config.reconstruction.backend == "cuda") throw;
    backend = on_the_cpu(error.what());
  }
  return nullptr;
}

}  // namespace

std::unique_ptr<LightFieldDevice> make_tried_device(const Config& config, const LightFieldDevicePlan& plan,
                                                    Backend& backend) {
  return make_tried(
      config, backend, "the particles of a test image", [&] { return make_light_field_cuda(plan); },
      [&](LightFieldDevice& device) { return try_device(device, plan); });
}

std::unique_ptr<DetectDevice> make_tried_device(const Config& config, const DetectDevicePlan& plan, Backend& backend) {
  return make_tried(
      config, backend, "the particle images of a test frame set", [&] { return make_detect_cuda(plan); },
      [&](DetectDevice& device) { return try_device(device, plan, thread_count(config.multi_view.threads)); });
}

std::unique_ptr<MatchDevice> make_tried_device(const Config& config, const MatchDevicePlan& plan, Backend& backend) {
  if (backend.device && config.multi_view.ghosts != "views") {
    backend = {false, fmt::format("matching on the CPU: multi_view.ghosts = \"{}\", and the device does \"views\"",
                                  config.multi_view.ghosts)};
    return nullptr;
  }
  return make_tried(
      config, backend, "the particles of listed particle images", [&] { return make_match_cuda(plan); },
      [&](MatchDevice& device) { return try_device(device, plan); });
}

}  // namespace rptv
