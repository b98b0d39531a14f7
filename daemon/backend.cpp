// SPDX-License-Identifier: MIT
// "auto" falls back to the CPU and says why; "cuda" is an error where it cannot be had.
#include "daemon/backend.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "reconstruct/light_field/light_field_cuda.hpp"

namespace rptv {

namespace {

/// Why this configuration cannot use a device; empty: it can.
std::string obstacle(const Config& config, const CudaProbe& probe) {
  if (!probe.usable) return probe.text;
  if (config.reconstruction.is_multi_view())
    return "reconstruction.kind = \"multi_view\" runs on the CPU only in this version";
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

Backend judge(const Config& config, const std::string& device, const DeviceTrial& trial) {
  const bool must = config.reconstruction.backend == "cuda";
  if (!trial.differs.empty()) {
    const std::string wrong = fmt::format(
        "{} does not repeat what the CPU makes of a test image: {}; report this with the output of nvidia-smi", device,
        trial.differs);
    if (!must) return on_the_cpu(wrong);
    throw Error(ExitCode::unavailable, "reconstruction.backend = \"cuda\": " + wrong);
  }
  if (must || trial.device_ms < trial.cpu_ms)
    return {true, fmt::format("reconstructing on {}: {:.2f} ms to the candidates of a test image, the CPU takes {:.2f}",
                              device, trial.device_ms, trial.cpu_ms)};
  return on_the_cpu(fmt::format("{:.2f} ms to the candidates of a test image, {} takes {:.2f}", trial.cpu_ms, device,
                                trial.device_ms));
}

std::unique_ptr<LightFieldDevice> make_tried_device(const Config& config, const LightFieldDevicePlan& plan,
                                                    Backend& backend) {
  if (!backend.device) return nullptr;
  try {
    auto device = make_light_field_cuda(plan);
    backend = judge(config, this_machine().text, try_device(*device, plan));
    if (backend.device) return device;
  } catch (const Error& error) {
    if (config.reconstruction.backend == "cuda") throw;
    backend = on_the_cpu(error.what());
  }
  return nullptr;
}

}  // namespace rptv
