// SPDX-License-Identifier: MIT
// Errors of fitted particles beside the Cramér-Rao bound of their scene, and beside what their covariances promise.
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <ostream>

#include "tests/bench/light_field_bench.hpp"
#include "tests/bench/light_field_scene.hpp"

namespace rptv::bench {

namespace {

/// Sums over particles, per axis.
struct AxisSums {
  double n = 0;
  std::array<double, 3> square{}, bound{}, normalised{}, by_bound{};

  void add(const std::array<double, 3>& error, const std::array<double, 3>& variance,
           const std::array<double, 3>& least) noexcept {
    ++n;
    for (std::size_t k = 0; k < 3; ++k) {
      square[k] += error[k] * error[k], bound[k] += least[k];
      normalised[k] += error[k] * error[k] / variance[k], by_bound[k] += error[k] * error[k] / least[k];
    }
  }
};

/// Depths near the array, where few lenslets see a particle, and the rest on either side.
struct Outcome {
  std::size_t truth = 0, found = 0, ghosts = 0;
  AxisSums before, near, behind;
};

void add_scene(const KnownScene& scene, Outcome& outcome) {
  LightFieldSettings settings = scene.settings;
  settings.refine = true;
  LightField light_field(settings, scene.calibration, {});
  Particles found(8192);
  light_field.reconstruct(scene.view(), found);

  // Where the cone of light is less than two lenslets wide.
  const double shallow_mm = 2 * scene.calibration.pitch_mm() * scene.calibration.lens.image_f_number;
  const auto bounds = bounds_of(scene);
  const auto matches = match(found, scene);
  outcome.ghosts += found.size() - matches.size();
  outcome.truth += static_cast<std::size_t>(std::count(scene.in_view.begin(), scene.in_view.end(), 1));
  for (const auto& m : matches) {
    if (scene.in_view[m.truth] == 0) continue;
    ++outcome.found;
    const auto& at = scene.truth[m.truth].at;
    const auto& c = found.covariance_mm2[m.found];
    const auto& least = bounds[m.truth];
    AxisSums& sums = std::abs(at.z) < shallow_mm ? outcome.near : at.z < 0 ? outcome.behind : outcome.before;
    sums.add({found.x_mm[m.found] - at.x, found.y_mm[m.found] - at.y, found.z_mm[m.found] - at.z}, {c[0], c[3], c[5]},
             {least.xx, least.yy, least.zz});
  }
}

void print(std::ostream& out, const char* where, const AxisSums& sums) {
  if (sums.n < 1) return;
  const auto rms_um = [&](double sum) { return 1e3 * std::sqrt(sum / sums.n); };
  for (std::size_t k = 0; k < 3; ++k)
    out << "    " << std::left << std::setw(14) << (k == 0 ? where : "") << "xyz"[k] << std::right << std::fixed
        << std::setprecision(0) << std::setw(8) << (k == 0 ? sums.n : 0) << std::setprecision(2) << std::setw(12)
        << rms_um(sums.square[k]) << std::setw(12) << rms_um(sums.bound[k]) << std::setw(10)
        << std::sqrt(sums.square[k] / sums.bound[k]) << std::setw(14) << sums.by_bound[k] / sums.n << std::setw(14)
        << sums.normalised[k] / sums.n << '\n';
}

void print(std::ostream& out, const std::string& name, const Outcome& outcome) {
  out << "  " << name << ": " << outcome.found << " of " << outcome.truth << " found, " << outcome.ghosts
      << " ghosts\n";
  print(out, "before array", outcome.before);
  print(out, "near array", outcome.near);
  print(out, "behind array", outcome.behind);
}

}  // namespace

void bench_accuracy(std::ostream& out, const LightFieldBenchOptions&) {
  out << "\nfitted particles beside the Cramer-Rao bound, image space\n"
      << "    where         axis  number      rms um    bound um     ratio  (error/bound)2  (error/sigma)2\n";
  auto scenario = random_scenario();
  scenario.rays_per_particle = 8192;
  for (const char* lenslets : {"thin", "plano_convex"}) {
    scenario.lenslets.model = lenslets;
    Outcome outcome;
    for (std::uint64_t frame = 0; frame < 8; ++frame) add_scene(simulated_scene("", scenario, frame), outcome);
    print(out, std::string("own scene, lenslets ") + lenslets, outcome);
  }
  for (const char* set : {"lf-macro", "lf-edge"})
    if (const auto scene = double_gauss_scene(set, "combined.png")) {
      Outcome outcome;
      add_scene(*scene, outcome);
      print(out, set, outcome);
    }
  Outcome wall;
  for (const std::uint64_t frame : {0U, 20U, 40U})
    if (const auto scene = wall_scene(frame)) add_scene(*scene, wall);
  print(out, "lf-wall", wall);
}

}  // namespace rptv::bench
