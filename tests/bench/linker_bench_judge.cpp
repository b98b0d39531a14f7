// SPDX-License-Identifier: MIT
// The linker judged against the truth by the definitions of the LPT challenge (simulation/score) and of proPTV.
#include <cmath>
#include <cstdio>
#include <map>

#include "simulation/score.hpp"
#include "tests/bench/linker_bench.hpp"
#include "tracking/linker.hpp"

namespace rptv {

namespace {

constexpr std::size_t kCount = 1000;
constexpr std::size_t kFrames = 30;

struct Judged {
  Score score;
  std::size_t correct = 0, wrong = 0;  ///< tracks of one true particle from first to last point; of several
};

Judged judge(const LinkCase& c) {
  MovingPoints points(c.count, c.steps, c.ratio, 3);
  std::vector<VelocitySample> known;
  for (const auto& [p, d] : points.known_flow()) known.push_back({p.x, p.y, p.z, d.x * 100, d.y * 100, d.z * 100});
  Linker linker(settings_of(c));
  if (c.predict != "none") linker.seed(known);
  Particles particles(c.count);
  Tracks tracks(linker.capacity());
  Measurement measured{{}, true};
  std::vector<TruthRow> truth;
  std::map<std::uint64_t, std::pair<std::uint64_t, bool>> tracks_seen;  // first true particle, and whether always it
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    points.next(particles);
    linker.next(particles, frame, static_cast<std::int64_t>(frame) * kBenchPeriodNs, tracks);
    for (std::size_t i = 0; i < c.count; ++i) {
      TrackRow row{frame, tracks.particle[i], particles.x_mm[i], particles.y_mm[i], particles.z_mm[i], 0, 0, 0, 0, 0,
                   0};
      measured.rows.push_back(row);
      row.particle = points.identity()[points.truth()[i]];
      truth.push_back({row, true});
      const auto [seen, fresh] = tracks_seen.try_emplace(tracks.particle[i], row.particle, true);
      seen->second.second = seen->second.second && seen->second.first == row.particle;
    }
  }
  Judged result;
  result.score = score(measured, truth, {{1e-6, 1e-6, 1e-6}});
  for (const auto& [id, seen] : tracks_seen) (seen.second ? result.correct : result.wrong) += 1;
  return result;
}

}  // namespace

void print_judgement() {
  std::puts(
      "\ntracks against the truth: 1000 particles, 30 frames, steady flow; ratio = fastest displacement / spacing");
  std::puts("predict             ratio  range  purity coverage fragments  correct   wrong switches");
  for (const char* predict : {"none", "velocity", "flow", "kalman", "kalman_acceleration"})
    for (const double ratio : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      const double range = std::string(predict) == "none" ? 1.1 * ratio : 0.1 + 0.25 * ratio;
      const Judged j = judge({"flow", MovingPoints::Steps::flow, kCount, ratio, range, predict});
      std::printf("%-19s %5.1f %6.3f %7.4f %8.4f %9.3f %8zu %7zu %8llu\n", predict, ratio, range, j.score.track.purity,
                  j.score.track.coverage, j.score.track.fragmentation, j.correct, j.wrong,
                  static_cast<unsigned long long>(j.score.track.id_switches));
    }
}

}  // namespace rptv
