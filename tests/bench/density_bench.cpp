// SPDX-License-Identifier: MIT
// How many particles a light field holds: recall, precision and errors by particles per lenslet.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <ostream>

#include "tests/bench/light_field_bench.hpp"
#include "tests/bench/light_field_scene.hpp"

namespace rptv::bench {

namespace {

constexpr double kHalfPitchMm = 0.0625, kDepthMm = 2;

struct Row {
  double truth = 0, found = 0, matched = 0, measured = 0, seconds = 0;
  std::array<double, 3> square{};
};

void add_scene(const KnownScene& scene, bool refine, Row& row) {
  LightFieldSettings settings = scene.settings;
  settings.refine = refine;
  settings.max_particles = 16384;
  LightField light_field(settings, scene.calibration, {});
  Particles found(16384);
  const auto start = std::chrono::steady_clock::now();
  light_field.reconstruct(scene.view(), found);
  row.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row.truth += static_cast<double>(std::count(scene.in_view.begin(), scene.in_view.end(), 1));
  row.measured += static_cast<double>(found.size());
  for (const auto& m : match(found, scene, kHalfPitchMm, kDepthMm)) {
    ++row.matched;
    if (scene.in_view[m.truth] == 0) continue;
    ++row.found;
    const auto& at = scene.truth[m.truth].at;
    const std::array<double, 3> error{found.x_mm[m.found] - at.x, found.y_mm[m.found] - at.y,
                                      found.z_mm[m.found] - at.z};
    for (std::size_t k = 0; k < 3; ++k) row.square[k] += error[k] * error[k];
  }
}

}  // namespace

void bench_density(std::ostream& out, const LightFieldBenchOptions&) {
  out << "\nparticles per lenslet; found within half a pitch aside and 2 mm of image depth\n"
      << "    depth mm  per lenslet  way              truth   recall %  precision %    rms um x       y         z   "
         "s\n";
  for (const double depth_mm : {2.0, 6.0})
    for (const double density : {0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5})
      for (const bool refine : {false, true}) {
        Row row;
        add_scene(simulated_scene("", dense_scenario(density, depth_mm), 0), refine, row);
        out << std::fixed << std::setprecision(0) << std::setw(12) << depth_mm << std::setprecision(2) << std::setw(13)
            << density << "  " << std::left << std::setw(15) << (refine ? "grey values" : "least squares") << std::right
            << std::setprecision(0) << std::setw(7) << row.truth << std::setprecision(1) << std::setw(11)
            << 100 * row.found / row.truth << std::setw(13) << 100 * row.matched / row.measured;
        for (const double square : row.square) out << std::setw(10) << 1e3 * std::sqrt(square / row.found);
        out << std::setw(8) << row.seconds << std::endl;
      }
}

}  // namespace rptv::bench
