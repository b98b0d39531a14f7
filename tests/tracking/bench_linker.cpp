// SPDX-License-Identifier: MIT
// Cost of linking one frame: percentiles of this thread's CPU time over seeded workloads, beside the floor of a sort.
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "tests/tracking/moving_points.hpp"
#include "tracking/cell_grid.hpp"
#include "tracking/linker.hpp"

namespace rptv {
namespace {

constexpr std::int64_t kPeriodNs = 10'000'000;

double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double percentile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(values.size())))];
}

struct Case {
  const char* name;
  MovingPoints::Steps steps;
  double ratio, search_range_mm;
};

void measure(const Case& c, std::size_t count, std::size_t frames) {
  LinkerSettings settings;
  settings.search_range_mm = c.search_range_mm;
  settings.memory = 0;
  settings.max_particles = settings.max_tracks = static_cast<std::int64_t>(count);
  Linker linker(settings);
  CellGrid floor(count);
  MovingPoints points(count, c.steps, c.ratio, 1);
  Particles particles(count);
  Tracks tracks(linker.capacity());
  std::vector<double> link_ms, floor_ms;
  std::vector<std::uint64_t> id_of(count), next_id_of(count);
  std::uint64_t right = 0, possible = 0;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    points.next(particles);
    const double begin = thread_ms();
    linker.next(particles, frame, static_cast<std::int64_t>(frame) * kPeriodNs, tracks);
    const double linked = thread_ms();
    floor.build(particles.x_mm.data(), particles.y_mm.data(), particles.z_mm.data(), count,
                {c.search_range_mm, c.search_range_mm, c.search_range_mm});
    const double sorted = thread_ms();
    for (std::size_t i = 0; i < count; ++i) next_id_of[points.truth()[i]] = tracks.particle[i];
    for (std::size_t i = 0; i < count && frame > 0; ++i) right += next_id_of[i] == id_of[i] ? 1 : 0;
    std::swap(id_of, next_id_of);
    if (frame < 3) continue;  // caches and branch predictors warm up
    possible += count;
    link_ms.push_back(linked - begin);
    floor_ms.push_back(sorted - linked);
  }
  const LinkerCounters& counters = linker.counters();
  std::printf("%-6s %6zu %5.2f %6.3f  %8.3f %8.3f %8.3f  %7.1f %8.3f  %6.4f %8llu %6llu\n", c.name, count, c.ratio,
              c.search_range_mm, percentile(link_ms, 0.5), percentile(link_ms, 0.99), percentile(link_ms, 1.0),
              percentile(link_ms, 0.5) * 1e6 / static_cast<double>(count), percentile(floor_ms, 0.5),
              static_cast<double>(right) / static_cast<double>(possible + 2 * count),
              static_cast<unsigned long long>(counters.largest_subnet),
              static_cast<unsigned long long>(counters.truncated_searches));
}

}  // namespace
}  // namespace rptv

int main(int argc, char** argv) {
  using Steps = rptv::MovingPoints::Steps;
  const std::size_t frames = argc > 1 ? std::stoul(argv[1]) : 103;
  std::puts("linking one frame, CPU time of one thread, ms; spacing 1; floor: sorting the particles into cells");
  std::puts("case        N ratio  range       p50      p99      max     ns/N    floor   right  largest   trunc");
  for (const std::size_t count : {100, 1000, 5000, 20000})
    for (const rptv::Case& c :
         {rptv::Case{"walk", Steps::walk, 0.1, 0.105}, rptv::Case{"walk", Steps::walk, 0.3, 0.315},
          rptv::Case{"walk", Steps::walk, 0.5, 0.525}, rptv::Case{"gauss", Steps::gauss, 0.5, 1.0},
          rptv::Case{"gauss", Steps::gauss, 0.5, 1.5}})
      rptv::measure(c, count, frames);
}
