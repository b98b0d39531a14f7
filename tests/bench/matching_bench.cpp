// SPDX-License-Identifier: MIT
// Matching four views of 100 to 4000 particles on one core: time, and how many are right.
#include <fmt/format.h>

#include <algorithm>

#include "reconstruct/multi_view/correspondence.hpp"
#include "reconstruct/multi_view/view_fit.hpp"
#include "reconstruct/multi_view/view_ghosts.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/views_bench.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv::bench {

namespace {

void bench_one(std::ostream& out, std::size_t particles, bool tank, int rounds) {
  const testing::ViewScene scene = testing::make_scene(4, particles, 0.1, 0, tank);
  const auto rays = testing::rays_of(scene);
  CorrespondenceOptions options;
  options.tolerance_px = 0.5;
  Correspondence correspondence(rays, scene.volume, options);
  ViewGhosts ghosts(4, options.max_detections, options.max_matches, {options.tolerance_px, false});
  std::span<const ViewMatch> matches;
  std::span<const std::uint32_t> chosen;
  Contest contest;
  contest.add("match", [&] { matches = correspondence.match(scene.detections); });
  contest.add("choose", [&] {
    ghosts.clear();
    chosen = ghosts.choose(matches);
  });
  double sink = 0;
  contest.add("fit", [&] {
    for (const std::uint32_t m : chosen)
      sink += fit_views(correspondence.views(), scene.detections, matches[m], 0.05).x_mm;
  });
  contest.run(rounds);
  std::size_t right = 0;
  for (const ViewTuple& truth : scene.tuples)
    right += std::any_of(chosen.begin(), chosen.end(), [&](auto m) { return matches[m].tuple == truth; }) ? 1 : 0;
  out << fmt::format("{:<8}{:>10}{:>10.3f}{:>10.3f}{:>10.3f}{:>12.2f}{:>10}{}\n", tank ? "water" : "air", particles,
                     contest.median_ms(0), contest.median_ms(1), contest.median_ms(2),
                     100.0 * static_cast<double>(right) / static_cast<double>(particles), chosen.size() - right,
                     sink == 0 ? " " : "");
}

}  // namespace

void bench_matching(std::ostream& out, int rounds) {
  out << fmt::format(
      "\nfour views, 0.1 px noise, 0.5 px tolerance, 200 mm cube; detections to matches, ghosts, fit; one "
      "core\n{:<8}{:>10}{:>10}{:>10}{:>10}{:>12}{:>10}\n",
      "", "particles", "match ms", "choose ms", "fit ms", "right %", "ghosts");
  for (const bool tank : {false, true})
    for (const std::size_t particles : {100UL, 300UL, 1000UL, 2000UL, 4000UL}) bench_one(out, particles, tank, rounds);
}

}  // namespace rptv::bench
