// SPDX-License-Identifier: MIT
// Ghost probabilities: how they are fitted, and how often what has them is a ghost.
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <ostream>

#include "reconstruct/light_field/ghost_probability.hpp"
#include "tests/bench/light_field_bench.hpp"
#include "tests/bench/light_field_scene.hpp"

namespace rptv::bench {

namespace {

constexpr int kFeatures = 1 + GhostEvidence::kCount, kNewtonSteps = 25;
constexpr double kRidge = 1e-3;
constexpr double kHalfPitchMm = 0.0625, kDepthMm = 2;

struct Sample {
  Eigen::Vector<double, kFeatures> features;
  double published;
  bool ghost;
};

// Scenes of several densities, depths and brightnesses; `first_frame` tells those to fit from those to judge by.
std::vector<Sample> samples(std::uint64_t first_frame, bool refine) {
  std::vector<Sample> all;
  for (const double per_lenslet : {0.04, 0.1, 0.15})
    for (const double depth_mm : {2.0, 6.0})
      for (const double light : {5000.0, 15000.0})
        for (std::uint64_t frame = first_frame; frame < first_frame + 3; ++frame) {
          auto scenario = dense_scenario(per_lenslet, depth_mm);
          scenario.seeding.photoelectrons = light;
          auto scene = simulated_scene("", scenario, frame);
          scene.settings.refine = refine;
          LightField light_field(scene.settings, scene.calibration, {});
          Particles found(4096);
          light_field.reconstruct(scene.view(), found);
          std::vector<char> real(found.size());
          for (const auto& m : match(found, scene, kHalfPitchMm, kDepthMm)) real[m.found] = 1;
          std::vector<double> lights;
          for (const auto& p : light_field.fitted()) lights.push_back(p.light);
          if (lights.empty()) continue;
          std::nth_element(lights.begin(), lights.begin() + static_cast<std::ptrdiff_t>(lights.size() / 2),
                           lights.end());
          for (std::size_t i = 0; i < found.size(); ++i) {
            const FittedParticle& p = light_field.fitted()[i];
            const GhostEvidence e = ghost_evidence(p, lights[lights.size() / 2]);
            Sample sample{{1, e.bright, e.weak, e.misfit, e.crowded}, found.ghost[i], real[i] == 0};
            if (!refine)  // least squares knows the support only
              sample.features << 1, std::log(p.support / light_field.min_count()), 0, 0, 0;
            all.push_back(sample);
          }
        }
  return all;
}

// Maximum likelihood by Newton's method; the ridge keeps features that say nothing at 0.
Eigen::Vector<double, kFeatures> logistic_fit(const std::vector<Sample>& samples) {
  Eigen::Vector<double, kFeatures> factors = Eigen::Vector<double, kFeatures>::Zero();
  for (int step = 0; step < kNewtonSteps; ++step) {
    Eigen::Matrix<double, kFeatures, kFeatures> curvature = kRidge * decltype(curvature)::Identity();
    Eigen::Vector<double, kFeatures> pull = -kRidge * factors;
    for (const auto& s : samples) {
      const double p = 1 / (1 + std::exp(-factors.dot(s.features)));
      pull += ((s.ghost ? 1 : 0) - p) * s.features;
      curvature += p * (1 - p) * s.features * s.features.transpose();
    }
    factors += curvature.ldlt().solve(pull);
  }
  return factors;
}

void print_reliability(std::ostream& out, const std::vector<Sample>& samples) {
  constexpr std::array<double, 8> kEdges{0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0001};
  out << "      predicted    particles  mean predicted  seen\n";
  for (std::size_t bin = 0; bin + 1 < kEdges.size(); ++bin) {
    double n = 0, predicted = 0, ghosts = 0;
    for (const auto& s : samples)
      if (s.published >= kEdges[bin] && s.published < kEdges[bin + 1]) ++n, predicted += s.published, ghosts += s.ghost;
    out << std::fixed << std::setprecision(2) << "      " << kEdges[bin] << " .. " << std::min(kEdges[bin + 1], 1.0)
        << std::setprecision(0) << std::setw(12) << n << std::setprecision(3) << std::setw(16)
        << predicted / std::max(n, 1.0) << std::setw(6) << ghosts / std::max(n, 1.0) << '\n';
  }
}

}  // namespace

void bench_ghosts(std::ostream& out, const LightFieldBenchOptions&) {
  out << "\nghost probability: fitted to frames 0-2 of 12 scenes, judged by frames 3-5\n";
  for (const bool refine : {false, true}) {
    out << (refine ? "    grey values: factors of 1, bright, weak, misfit, crowded:"
                   : "    least squares: of 1, log support:");
    const auto factors = logistic_fit(samples(0, refine));
    for (int k = 0; k < (refine ? kFeatures : 2); ++k) out << ' ' << std::setprecision(3) << factors[k];
    out << '\n';
    print_reliability(out, samples(3, refine));
  }
}

}  // namespace rptv::bench
