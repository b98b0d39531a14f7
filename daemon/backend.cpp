// SPDX-License-Identifier: MIT
// "auto" falls back to the CPU and says why; "cuda" is an error where it cannot be had.
#include "daemon/backend.hpp"

#include <fmt/format.h>

#include <iostream>

#include "core/error.hpp"
#include "reconstruct/light_field/light_field_cuda.hpp"
#include "reconstruct/light_field/light_field_device_check.hpp"

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

std::unique_ptr<LightFieldDevice> make_checked_device(const LightFieldDevicePlan& plan) {
  auto device = make_light_field_cuda(plan);
  const std::string differs = disagreement(*device, plan);
  if (differs.empty()) return device;
  throw Error(ExitCode::unavailable,
              "CUDA: the device does not repeat what the CPU makes of a test image (" + differs +
                  "); take reconstruction.backend = \"cpu\" and report this with the output of nvidia-smi");
}

std::unique_ptr<LightFieldDevice> make_device_or_none(const LightFieldDevicePlan& plan) {
  try {
    return make_checked_device(plan);
  } catch (const Error& error) {
    std::cerr << "warning: reconstructing on the CPU: " << error.what() << '\n';
    return nullptr;
  }
}

}  // namespace

Backend choose_backend(const Config& config, const CudaProbe& probe) {
  const std::string& wanted = config.reconstruction.backend;
  if (wanted == "cpu") return {nullptr, "reconstructing on the CPU"};
  const std::string why_not = obstacle(config, probe);
  if (why_not.empty())
    return {wanted == "cuda" ? make_checked_device : make_device_or_none, "reconstructing on " + probe.text};
  if (wanted == "auto") return {nullptr, "reconstructing on the CPU: " + why_not};
  throw Error(ExitCode::unavailable,
              "reconstruction.backend = \"cuda\": " + why_not + "; \"auto\" and \"cpu\" do without");
}

Backend choose_backend(const Config& config) {
  static const CudaProbe probe = probe_cuda();
  return choose_backend(config, config.reconstruction.backend == "cpu" ? CudaProbe{} : probe);
}

}  // namespace rptv
