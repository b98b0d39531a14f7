// SPDX-License-Identifier: MIT
// Frames, CPU, hand-over times and allocations of a live GenICam camera's source; compare_cameras.py runs its peer too.
#include <sys/resource.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "acquisition/aravis_source.hpp"
#include "acquisition/intake.hpp"
#include "core/latency.hpp"
#include "tests/core/allocation_counter.hpp"

namespace rptv {
namespace {

struct Arguments {
  std::string address;
  double rate_hz = 0, seconds = 0;
  std::int64_t packet_size = 0;
};

double cpu_s() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec) * 1e-6;
}

void measure(const Arguments& arguments) {
  AravisSettings settings;
  settings.cameras = {arguments.address};
  settings.region = {0, 0, 1920, 1200};
  settings.rate_hz = arguments.rate_hz;
  settings.packet_size = arguments.packet_size;
  AravisSource source(settings, 32);
  Intake intake(source.cameras(), {Bounded{8}, 32, 4});
  source.start(intake);
  FrameSet set;
  LatencyHistogram hand_over;
  std::uint64_t warm = 0;
  while (warm < 20 && intake.next(set, 10'000'000'000) == Taken::value) ++warm;
  const double cpu_before_s = cpu_s();
  AllocationCounter allocations;
  const std::int64_t start_ns = host_now_ns(), end_ns = start_ns + static_cast<std::int64_t>(arguments.seconds * 1e9);
  std::int64_t now_ns = start_ns;
  while (now_ns < end_ns) {
    if (intake.next(set, 100'000'000) == Taken::value) hand_over.record(host_now_ns() - set.info().arrival_ns);
    now_ns = host_now_ns();
  }
  const std::uint64_t allocated = allocations.disarm();
  const double cpu = cpu_s() - cpu_before_s, seconds = static_cast<double>(now_ns - start_ns) * 1e-9;
  const auto frames = static_cast<double>(hand_over.count());
  const auto us = [&](double fraction) { return static_cast<double>(hand_over.percentile_ns(fraction)) * 1e-3; };
  std::printf("frames %.0f fps %.1f cpu_us_per_frame %.1f lost %llu allocations_per_frame %.1f\n", frames,
              frames / seconds, 1e6 * cpu / frames, static_cast<unsigned long long>(intake.losses(0).total()),
              static_cast<double>(allocated) / frames);
  std::printf("driver to reconstruct, us: P50 %.1f P99 %.1f P99.9 %.1f max %.1f\n", us(0.5), us(0.99), us(0.999),
              static_cast<double>(hand_over.max_ns()) * 1e-3);
  set.reset();
  intake.close();
  source.stop();
  std::printf("%s\n", source.device_status().front().link.c_str());
}

}  // namespace
}  // namespace rptv

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: rptv_bench_camera ADDRESS RATE_HZ SECONDS PACKET_SIZE\n");
    return 64;
  }
  try {
    rptv::measure({argv[1], std::atof(argv[2]), std::atof(argv[3]), std::atoll(argv[4])});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 69;
  }
  return 0;
}
