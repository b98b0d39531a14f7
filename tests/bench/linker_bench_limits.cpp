// SPDX-License-Identifier: MIT
// The linker at its limits: growth with number and density, hostile frames, an hour of them.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>
#include <random>

#include "tests/bench/linker_bench.hpp"
#include "tracking/linker.hpp"

namespace rptv {

namespace {

double resident_mib() {
  std::ifstream file("/proc/self/statm");
  long pages = 0, resident = 0;
  file >> pages >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576.0;
}

double median_ms(const LinkCase& c, double& floor_ms) {
  const LinkTimes times = measure(c, 25, 1);
  floor_ms = percentile(times.floor_ms, 0.5);
  return percentile(times.frame_ms, 0.5);
}

void print_growth_line(const LinkCase& c, double density) {
  double floor_ms = 0;
  const double ms = median_ms(c, floor_ms);
  std::printf("%-6s %7zu %6.3f  %10.3f %8.3f %8.1f %8.1f %6.1f\n", c.name.c_str(), c.count, c.search_range_mm, density,
              ms, ms * 1e6 / static_cast<double>(c.count), floor_ms * 1e6 / static_cast<double>(c.count),
              ms / floor_ms);
}

/// The slowest of some frames of one kind, and what the linker said of them.
template <class Fill>
void print_hostile_line(const char* name, std::size_t count, double deadline_ms, Fill&& fill) {
  LinkerSettings settings;
  settings.search_range_mm = 1;
  settings.deadline_ms = deadline_ms;
  settings.max_particles = settings.max_tracks = static_cast<std::int64_t>(count);
  Linker linker(settings);
  Particles particles(count);
  Tracks tracks(linker.capacity());
  double slowest = 0;
  for (std::size_t frame = 0; frame < 4; ++frame) {
    particles.clear();
    for (std::size_t i = 0; i < count; ++i) particles.push(fill(i));
    const double begin = thread_ms();
    linker.next(particles, frame, static_cast<std::int64_t>(frame) * kBenchPeriodNs, tracks);
    slowest = std::max(slowest, thread_ms() - begin);
  }
  const LinkerCounters& c = linker.counters();
  std::printf("%-44s %7zu %8.0f %9.1f %8llu %8llu %9llu\n", name, count, deadline_ms, slowest,
              static_cast<unsigned long long>(c.links), static_cast<unsigned long long>(c.cut_subnets),
              static_cast<unsigned long long>(c.truncated_searches));
  std::fflush(stdout);
}

}  // namespace

void print_growth() {
  using Steps = MovingPoints::Steps;
  std::puts("\ncost with N at 0.145 chance candidates a particle, and with density at 5000 particles");
  std::puts("case         N  range  candidates   p50 ms     ns/N  floor/N  ratio");
  const auto candidates = [](double range) { return 4.18879 * range * range * range; };
  for (const std::size_t n : {100, 300, 1000, 3000, 10'000, 30'000, 100'000})
    print_growth_line({"walk", Steps::walk, n, 0.31, 0.3255, "none"}, candidates(0.3255));
  for (const double range : {0.1, 0.3, 0.5, 0.7, 1.0, 1.3, 1.6, 2.0})
    print_growth_line({"gauss", Steps::gauss, 5000, range / 3, range, "none"}, candidates(range));
}

void print_hostile() {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  const auto within = [&](double side) {
    return Particle{side * share(random), side * share(random), side * share(random), 0, 0, {}};
  };
  std::puts("\nhostile frames, slowest of 4; CPU time of one thread, ms; deadline 0: none, all exact");
  std::puts("frames                                             N deadline   slowest    links      cut truncated");
  for (const double deadline_ms : {0.0, 50.0}) {
    print_hostile_line("all at one place", 10'000, deadline_ms,
                       [](std::size_t) { return Particle{1, 1, 1, 0, 0, {}}; });
    print_hostile_line("all within one search range", 10'000, deadline_ms, [&](std::size_t) { return within(0.5); });
    print_hostile_line("20 in range of each", 100'000, deadline_ms, [&](std::size_t) { return within(27.5); });
    print_hostile_line("all NaN", 100'000, deadline_ms,
                       [&](std::size_t) { return Particle{kNan, kNan, kNan, 0, 0, {}}; });
    print_hostile_line("one outlier at 1e9", 100'000, deadline_ms,
                       [&](std::size_t i) { return i == 7 ? Particle{1e9, 0, 0, 0, 0, {}} : within(100); });
    print_hostile_line("all within one search range", 100'000, deadline_ms, [&](std::size_t) { return within(0.5); });
  }
}

void print_hour() {
  constexpr std::size_t kCount = 1000;
  constexpr std::size_t kFrames = 540'000;
  std::puts(
      "\none hour at 150 frames a second of 1000 particles, simulated time; memory 3; predicted by velocity, which");
  std::puts("a random walk does not follow, so that many tracks end in every frame");
  LinkerSettings settings;
  settings.search_range_mm = 0.315;
  settings.predict = "velocity";
  settings.max_particles = settings.max_tracks = 4 * kCount;
  Linker linker(settings);
  MovingPoints points(kCount, MovingPoints::Steps::walk, 0.3, 1);
  std::vector<Particles> frames(200, Particles(kCount));  // there and back: a walk does not leave its cube in an hour
  for (Particles& frame : frames) points.next(frame);
  Tracks tracks(linker.capacity());
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    const std::size_t phase = frame % 398;
    const Particles& now = frames[phase < 200 ? phase : 398 - phase];
    linker.next(now, frame, static_cast<std::int64_t>(frame) * 6'666'667, tracks);
    if (frame == 1000 || (frame + 1) % 90'000 == 0)
      std::printf("frame %7zu: %8.2f MiB resident, %8llu tracks so far\n", frame, resident_mib(),
                  static_cast<unsigned long long>(linker.counters().births));
    std::fflush(stdout);
  }
}

}  // namespace rptv
