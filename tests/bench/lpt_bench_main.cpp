// SPDX-License-Identifier: MIT
// rptv_bench_lpt [--part=P] [--frames=N] [--method=iterative|detections] [PPP…]: recall, precision and errors by
// density.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "core/clock.hpp"
#include "reconstruct/multi_view/iterative_views.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/lpt_scene.hpp"

namespace rptv::bench {
namespace {

struct Options {
  double part = 0.5;
  std::uint64_t frames = 1;
  std::string method = "iterative";
  std::vector<double> per_pixel;
};

std::unique_ptr<Reconstructor> make(const MultiViewSettings& settings, const LptScene& scene) {
  const auto cameras = scene.cameras();
  if (settings.method == "iterative") return std::make_unique<IterativeViews>(settings, scene.rig(), cameras);
  return std::make_unique<MultiView>(settings, scene.rig(), cameras);
}

void run(const Options& options, double per_pixel) {
  LptScene scene(per_pixel, options.part);
  MultiViewSettings settings = scene.settings();
  settings.method = options.method;
  const auto stage = make(settings, scene);
  Particles particles(static_cast<std::size_t>(settings.max_particles));
  DetectionScore sum;
  double square_mm2 = 0, ms = 0;
  for (std::uint64_t frame = 0; frame < options.frames; ++frame) {
    FrameSet& frames = scene.frames(frame);
    const std::int64_t start_ns = host_now_ns();
    stage->reconstruct(frames, particles);
    ms += 1e-6 * static_cast<double>(host_now_ns() - start_ns);
    const DetectionScore one = scene.judge(particles);
    sum.truth += one.truth, sum.found += one.found, sum.measured += one.measured, sum.ghosts += one.ghosts;
    square_mm2 += one.rms_mm * one.rms_mm * static_cast<double>(one.found);
  }
  const double rms_mm = std::sqrt(square_mm2 / static_cast<double>(sum.found));
  std::cout << fmt::format("{:<8}{:>10}{:>10.2f}{:>12.2f}{:>10.4f}{:>10.3f}{:>12.0f}\n", per_pixel,
                           sum.truth / options.frames,
                           100.0 * static_cast<double>(sum.found) / static_cast<double>(sum.truth),
                           100.0 * static_cast<double>(sum.measured - sum.ghosts) / static_cast<double>(sum.measured),
                           rms_mm, rms_mm * scene.px_per_mm(), ms / static_cast<double>(options.frames))
            << std::flush;
}

}  // namespace
}  // namespace rptv::bench

int main(int argc, char** argv) {
  rptv::bench::Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const auto value = [&](const char* name) {
      return argument.starts_with(name) ? argument.substr(std::string(name).size()) : "";
    };
    if (const auto part = value("--part="); !part.empty())
      options.part = std::atof(part.c_str());
    else if (const auto frames = value("--frames="); !frames.empty())
      options.frames = static_cast<std::uint64_t>(std::max(1, std::atoi(frames.c_str())));
    else if (const auto method = value("--method="); !method.empty())
      options.method = method;
    else
      options.per_pixel.push_back(std::atof(argument.c_str()));
  }
  if (options.per_pixel.empty()) options.per_pixel = {0.005, 0.01, 0.025, 0.05, 0.08, 0.12};
  std::cout << rptv::bench::machine()
            << fmt::format("; {}, sensor part {}, {} frame sets\n", options.method, options.part, options.frames)
            << fmt::format("{:<8}{:>10}{:>10}{:>12}{:>10}{:>10}{:>12}\n", "ppp", "particles", "recall %", "precision %",
                           "rms mm", "rms px", "ms/set");
  for (const double per_pixel : options.per_pixel) rptv::bench::run(options, per_pixel);
}
