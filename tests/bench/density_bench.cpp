// SPDX-License-Identifier: MIT
// How many particles a light field holds: recall, precision and errors by particles per lenslet.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <random>
#include <string>

#include "reconstruct/light_field/shake.hpp"
#include "tests/bench/light_field_bench.hpp"
#include "tests/bench/light_field_scene.hpp"

namespace rptv::bench {

namespace {

constexpr double kHalfPitchMm = 0.0625, kDepthMm = 2;
constexpr std::size_t kMostParticles = 4096;
constexpr const char *kRays = "least squares", *kRefined = "grey values", *kWhole = "whole images",
                     *kTruth = "from truth";

struct Row {
  double truth = 0, found = 0, matched = 0, measured = 0;
  std::array<double, 3> square{};
};

void judge(const KnownScene& scene, const Particles& found, Row& row) {
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

void reconstruct(const KnownScene& scene, const std::string& way, Particles& found) {
  LightFieldSettings settings = scene.settings;
  settings.refine = way != kRays;
  settings.refine_rounds = 8;
  if (way == kWhole) settings.refine_search = "grey_values";
  settings.max_particles = kMostParticles;
  LightField(settings, scene.calibration, {}).reconstruct(scene.view(), found);
}

// The fit alone: particles start near where they are, as a perfect search would leave them.
void fit_from_truth(const KnownScene& scene, Particles& found) {
  ShakeOptions options = shake_options_of(scene);
  options.max_particles = kMostParticles;
  const LensletLattice lattice(scene.calibration);
  Shake shake(scene.calibration, lattice, options);
  const std::vector<float> background(scene.shape.pixels(), static_cast<float>(scene.settings.background));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> aside(-kHalfPitchMm / 2, kHalfPitchMm / 2), depth(-kDepthMm / 4, kDepthMm / 4);
  std::vector<FittedParticle> particles;
  for (const auto& p : scene.truth) {
    FittedParticle start;
    start.at = {p.at.x + aside(random), p.at.y + aside(random), p.at.z + depth(random)};
    particles.push_back(start);
  }
  shake.begin(scene.view(), background);
  particles.resize(shake.refine(particles, 0));
  found.clear();
  for (const auto& p : particles) found.push({p.at.x, p.at.y, p.at.z, p.residual_mm, p.support, {}});
}

}  // namespace

void bench_density(std::ostream& out, const LightFieldBenchOptions&) {
  out << "\nparticles per lenslet; found within half a pitch aside and 2 mm of image depth\n"
      << "    depth mm  per lenslet  way              truth   recall %  precision %    rms um x       y         z   "
         "s\n";
  for (const double depth_mm : {2.0, 6.0})
    for (const double density : {0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5})
      for (const std::string way : {kRays, kRefined, kWhole, kTruth}) {
        const KnownScene scene = simulated_scene("", dense_scenario(density, depth_mm), 0);
        Particles found(kMostParticles);
        const auto start = std::chrono::steady_clock::now();
        way == kTruth ? fit_from_truth(scene, found) : reconstruct(scene, way, found);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        Row row;
        judge(scene, found, row);
        out << std::fixed << std::setprecision(0) << std::setw(12) << depth_mm << std::setprecision(2) << std::setw(13)
            << density << "  " << std::left << std::setw(15) << way << std::right << std::setprecision(0)
            << std::setw(7) << row.truth << std::setprecision(1) << std::setw(11) << 100 * row.found / row.truth
            << std::setw(13) << 100 * row.matched / row.measured;
        for (const double square : row.square)
          out << std::setw(10) << 1e3 * std::sqrt(square / std::max(row.found, 1.0));
        out << std::setw(8) << seconds << std::endl;
      }
}

}  // namespace rptv::bench
