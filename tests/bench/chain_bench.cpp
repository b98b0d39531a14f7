// SPDX-License-Identifier: MIT
// From the detections of four views to particles, as MultiView does it, by one thread and by several: time by the
// clock.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "reconstruct/multi_view/multi_view.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/views_bench.hpp"
#include "tests/reconstruct/multi_view/made_views.hpp"

namespace rptv::bench {

namespace {

struct Chain {
  Chain(const testing::ViewScene& scene, std::int64_t threads) {
    std::vector<MultiViewCamera> cameras;
    for (const RigCamera& camera : scene.rig.cameras) cameras.push_back({camera.name, {1920, 1200, 1}, {}});
    MultiViewSettings settings;
    settings.volume_x_mm = settings.volume_y_mm = settings.volume_z_mm = {-100, 100};
    settings.threads = threads;
    multi_view = std::make_unique<MultiView>(settings, scene.rig, cameras);
  }
  void run(const testing::ViewScene& scene) {
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    multi_view->reconstruct(scene.detections, found);
    ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  std::unique_ptr<MultiView> multi_view;
  Particles found{16384};
  std::vector<double> ms;
};

}  // namespace

void bench_chain(std::ostream& out, int rounds) {
  out << "\nfour views, 0.1 px noise, 1 px tolerance, 200 mm cube; detections to particles by the clock, ms: median "
         "(least)\n particles         1 thread        2 threads        4 threads     found\n";
  for (const std::size_t particles : {300UL, 1000UL, 4000UL}) {
    const testing::ViewScene scene = testing::make_scene(4, particles, 0.1);
    Chain chains[]{{scene, 1}, {scene, 2}, {scene, 4}};
    for (Chain& chain : chains) {
      chain.run(scene), chain.ms.clear();
      for (int round = 0; round < rounds; ++round) chain.run(scene);  // in turns, OpenMP's threads would end and begin
    }
    out << fmt::format("{:>10}", particles);
    for (const Chain& chain : chains)
      out << fmt::format("{:>9.3f} ({:.3f})", median(chain.ms), *std::min_element(chain.ms.begin(), chain.ms.end()));
    out << fmt::format("{:>10}\n", chains[0].found.size());
  }
}

}  // namespace rptv::bench
