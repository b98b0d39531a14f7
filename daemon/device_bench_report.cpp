// SPDX-License-Identifier: MIT
// What rounds on a device amount to, beside what the device can do at most.
#include <fmt/format.h>

#include <utility>

#include "core/json.hpp"
#include "daemon/device_bench.hpp"

namespace rptv {

namespace {

constexpr double kPercentiles[] = {0.5, 0.99, 0.999};

/// A stage's rates; 0: not known.
struct Rates {
  Rates(const StageCost& sum, CudaStage stage, const CudaDeviceLimits& limits) {
    if (sum.device_ms <= 0) return;
    bytes_per_s = static_cast<double>(sum.bytes) / (sum.device_ms * 1e-3);
    increments_per_s = static_cast<double>(sum.increments) / (sum.device_ms * 1e-3);
    const bool copies = stage == CudaStage::upload || stage == CudaStage::download;  // PCIe's limit, which is not asked
    const double most = copies ? 0 : limits.memory_bytes_per_s();
    bandwidth_used = most > 0 ? bytes_per_s / most : 0;
    increments_used = limits.increments_per_s() > 0 ? increments_per_s / limits.increments_per_s() : 0;
  }
  double bytes_per_s = 0, increments_per_s = 0, bandwidth_used = 0, increments_used = 0;
};

// Calls use(stage, its times) for those that did anything.
template <class Use>
void for_each_stage(const DeviceBenchResult& result, const Use& use) {
  for (std::size_t s = 1; s < kCudaStages; ++s)
    if (const DeviceStageTimes& stage = result.stages[s]; stage.sum.bytes > 0 || stage.sum.device_ms > 0)
      use(static_cast<CudaStage>(s), stage);
}

double ms(std::int64_t ns) { return static_cast<double>(ns) * 1e-6; }
std::string version(int number) { return fmt::format("{}.{}", number / 1000, number % 1000 / 10); }
std::string known(double value, const char* format) {
  return value > 0 ? fmt::format(fmt::runtime(format), value) : "-";
}
std::string json(double value) { return value > 0 ? fmt::format("{:.6g}", value) : "null"; }

std::string percentiles_json(const LatencyHistogram& times) {
  return fmt::format(R"("p50":{},"p99":{},"p99_9":{},"max":{})", times.percentile_ns(kPercentiles[0]),
                     times.percentile_ns(kPercentiles[1]), times.percentile_ns(kPercentiles[2]), times.max_ns());
}

}  // namespace

std::string to_text(const DeviceBenchResult& result, const CudaDeviceLimits& limits) {
  const LatencyHistogram& all = result.latency_ns;
  const auto rounds = static_cast<double>(all.count());
  std::string text = fmt::format(
      "{}, {} multiprocessors; at most {} GB/s and {} G increments/s; CUDA {}, driver for {}\n"
      "{} rounds from image to particles, copies included: P50 {:.3f}, P99 {:.3f}, P99.9 {:.3f}, max {:.3f} ms\n"
      "{:<24}{:>9}{:>9}{:>11}{:>9}{:>8}{:>13}{:>9}{:>8}\n",
      limits.name, limits.multiprocessors, known(limits.memory_bytes_per_s() * 1e-9, "{:.0f}"),
      known(limits.increments_per_s() * 1e-9, "{:.0f}"), version(limits.toolkit), version(limits.driver), all.count(),
      ms(all.percentile_ns(kPercentiles[0])), ms(all.percentile_ns(kPercentiles[1])),
      ms(all.percentile_ns(kPercentiles[2])), ms(all.max_ns()), "on the device, a round", "P50 ms", "P99 ms", "MB",
      "GB/s", "of most", "increments", "G/s", "of most");
  for_each_stage(result, [&](CudaStage s, const DeviceStageTimes& stage) {
    const Rates rates(stage.sum, s, limits);
    text += fmt::format("  {:<22}{:>9.3f}{:>9.3f}{:>11}{:>9}{:>8}{:>13}{:>9}{:>8}\n", name_of(s),
                        ms(stage.device_ns.percentile_ns(kPercentiles[0])),
                        ms(stage.device_ns.percentile_ns(kPercentiles[1])),
                        known(static_cast<double>(stage.sum.bytes) * 1e-6 / rounds, "{:.3f}"),
                        known(rates.bytes_per_s * 1e-9, "{:.1f}"), known(rates.bandwidth_used * 100, "{:.1f} %"),
                        known(static_cast<double>(stage.sum.increments) / rounds, "{:.0f}"),
                        known(rates.increments_per_s * 1e-9, "{:.2f}"), known(rates.increments_used * 100, "{:.1f} %"));
  });
  return text;
}

std::string to_json(const DeviceBenchResult& result, const CudaDeviceLimits& limits) {
  const auto rounds = static_cast<double>(result.latency_ns.count());
  std::string text = fmt::format(
      R"({{"device":{},"toolkit":"{}","driver":"{}","multiprocessors":{},"clock_hz":{},"memory_bytes_per_s":{},)"
      R"("increments_per_s":{},"rounds":{},"latency_ns":{{{}}},"stages":[)",
      json_string(limits.name), version(limits.toolkit), version(limits.driver), limits.multiprocessors,
      json(limits.clock_hz), json(limits.memory_bytes_per_s()), json(limits.increments_per_s()),
      result.latency_ns.count(), percentiles_json(result.latency_ns));
  const char* separator = "";
  for_each_stage(result, [&](CudaStage s, const DeviceStageTimes& stage) {
    const Rates rates(stage.sum, s, limits);
    text += fmt::format(
        R"({}{{"stage":{},"device_ns":{{{}}},"bytes":{:.10g},"increments":{:.10g},"bytes_per_s":{},"increments_per_s":{}}})",
        std::exchange(separator, ","), json_string(name_of(s)), percentiles_json(stage.device_ns),
        static_cast<double>(stage.sum.bytes) / rounds, static_cast<double>(stage.sum.increments) / rounds,
        json(rates.bytes_per_s), json(rates.increments_per_s));
  });
  return text + "]}\n";
}

}  // namespace rptv
