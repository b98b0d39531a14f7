// SPDX-License-Identifier: MIT
// rptv_bench_lpt [--part=P] [--frames=N] [--method=iterative|detections|tracks] [PPP…]: recall, precision and errors
// by density. `tracks` reconstructs where tracks are expected, links, and prints every frame set.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "reconstruct/multi_view/iterative_views.hpp"
#include "reconstruct/multi_view/multi_view.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/lpt_scene.hpp"
#include "tracking/linker.hpp"

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

/// Sums over frame sets, as one line.
struct Row {
  std::uint64_t truth = 0, found = 0, measured = 0, ghosts = 0, sets = 0;
  double square_mm2 = 0, ms = 0;

  void add(const DetectionScore& one, double took_ms) {
    truth += one.truth, found += one.found, measured += one.measured, ghosts += one.ghosts, ++sets;
    square_mm2 += one.rms_mm * one.rms_mm * static_cast<double>(one.found), ms += took_ms;
  }
  void print(const std::string& name, double px_per_mm) const {
    const double rms_mm = std::sqrt(square_mm2 / static_cast<double>(found));
    std::cout << fmt::format("{:<8}{:>10}{:>10.2f}{:>12.2f}{:>10.4f}{:>10.3f}{:>12.0f}\n", name, truth / sets,
                             100.0 * static_cast<double>(found) / static_cast<double>(truth),
                             100.0 * static_cast<double>(measured - ghosts) / static_cast<double>(measured), rms_mm,
                             rms_mm * px_per_mm, ms / static_cast<double>(sets))
              << std::flush;
  }
};

void run(const Options& options, double per_pixel) {
  LptScene scene(per_pixel, options.part);
  MultiViewSettings settings = scene.settings();
  const bool with_tracks = options.method == "tracks";
  settings.threads = 1;
  settings.method = with_tracks ? "iterative" : options.method;
  const auto stage = make(settings, scene);
  Particles particles(static_cast<std::size_t>(settings.max_particles));
  Linker linker(scene.linker_settings());
  Tracks tracks(linker.capacity());
  Row all;
  for (std::uint64_t frame = 0; frame < options.frames; ++frame) {
    FrameSet& frames = scene.frames(frame);
    const double start_ms = thread_cpu_ms();
    if (with_tracks) {
      linker.predict(scene.time_ns(frame), tracks);
      stage->expect(tracks);
    }
    stage->reconstruct(frames, particles);
    if (with_tracks) linker.next(particles, frame, scene.time_ns(frame), tracks);
    const double ms = thread_cpu_ms() - start_ms;
    const DetectionScore one = scene.judge(particles);
    all.add(one, ms);
    if (!with_tracks) continue;
    Row row;
    row.add(one, ms);
    row.print(fmt::format("#{}", frame), scene.px_per_mm());
  }
  all.print(fmt::format("{}", per_pixel), scene.px_per_mm());
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
            << fmt::format("; {}, sensor part {}, {} frame sets; CPU time of one thread for a frame set\n",
                           options.method, options.part, options.frames)
            << fmt::format("{:<8}{:>10}{:>10}{:>12}{:>10}{:>10}{:>12}\n", "ppp", "particles", "recall %", "precision %",
                           "rms mm", "rms px", "CPU ms");
  for (const double per_pixel : options.per_pixel) rptv::bench::run(options, per_pixel);
}
