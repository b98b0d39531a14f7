// SPDX-License-Identifier: MIT
// How one linking workload is made, timed and written.
#include "tests/bench/linker_bench.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>

#include "tracking/cell_grid.hpp"
#include "tracking/linker.hpp"

namespace rptv {

double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double percentile(std::vector<double> values, double fraction) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(fraction * static_cast<double>(values.size())))];
}

LinkerSettings settings_of(const LinkCase& c) {
  LinkerSettings settings;
  settings.search_range_mm = c.search_range_mm;
  settings.memory = 0;
  settings.predict = c.predict;
  settings.deadline_ms = 0;
  settings.max_particles = settings.max_tracks = static_cast<std::int64_t>(c.count);
  return settings;
}

LinkTimes measure(const LinkCase& c, std::size_t frames, std::uint64_t seed) {
  constexpr std::size_t kWarmUp = 3;
  Linker linker(settings_of(c));
  CellGrid floor(c.count);
  MovingPoints points(c.count, c.steps, c.ratio, seed);
  std::vector<VelocitySample> known;
  constexpr double kPerS = 1e9 / kBenchPeriodNs;
  if (c.predict != "none")
    for (const auto& [p, d] : points.known_flow())
      known.push_back({p.x, p.y, p.z, d.x * kPerS, d.y * kPerS, d.z * kPerS});
  if (!known.empty()) linker.seed(known);
  Particles particles(c.count);
  Tracks tracks(linker.capacity());
  LinkTimes times;
  std::vector<std::uint64_t> id_of(c.count), next_id_of(c.count), identity(c.count);
  std::uint64_t right = 0;
  std::uint64_t possible = 0;
  const double range = c.search_range_mm;
  for (std::size_t frame = 0; frame < frames + kWarmUp; ++frame) {
    points.next(particles);
    const double begin = thread_ms();
    linker.next(particles, frame, static_cast<std::int64_t>(frame) * kBenchPeriodNs, tracks);
    const double linked = thread_ms();
    floor.build(particles.x_mm.data(), particles.y_mm.data(), particles.z_mm.data(), c.count, {range, range, range});
    const double sorted = thread_ms();
    for (std::size_t i = 0; i < c.count; ++i) next_id_of[points.truth()[i]] = tracks.particle[i];
    for (std::size_t i = 0; i < c.count && frame > 0; ++i) {
      const bool stayed = points.identity()[i] == identity[i];
      possible += stayed ? 1 : 0;
      right += stayed && next_id_of[i] == id_of[i] ? 1 : 0;
    }
    std::swap(id_of, next_id_of);
    identity = points.identity();
    if (frame < kWarmUp) continue;
    times.frame_ms.push_back(linked - begin);
    times.floor_ms.push_back(sorted - linked);
  }
  times.right = static_cast<double>(right) / static_cast<double>(possible);
  times.largest_subnet = linker.counters().largest_subnet;
  times.truncated = linker.counters().truncated_searches;
  times.links = linker.counters().links;
  return times;
}

void write_points(const LinkCase& c, std::size_t frames, std::uint64_t seed) {
  MovingPoints points(c.count, c.steps, c.ratio, seed);
  std::vector<std::array<double, 3>> known(c.count);
  std::size_t i = 0;
  for (const auto& [p, d] : points.known_flow()) known[5 * i++] = {d.x, d.y, d.z};
  Particles particles(c.count);
  std::puts("frame,x,y,z,truth,known_vx,known_vy,known_vz");
  for (std::size_t frame = 0; frame < frames; ++frame) {
    points.next(particles);
    for (std::size_t row = 0; row < c.count; ++row) {
      const std::uint32_t truth = points.truth()[row];
      const auto& v = known[truth];
      std::printf("%zu,%.17g,%.17g,%.17g,%llu,%.9g,%.9g,%.9g\n", frame, particles.x_mm[row], particles.y_mm[row],
                  particles.z_mm[row], static_cast<unsigned long long>(points.identity()[truth]), frame == 0 ? v[0] : 0,
                  frame == 0 ? v[1] : 0, frame == 0 ? v[2] : 0);
    }
  }
}

}  // namespace rptv
