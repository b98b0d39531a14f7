// SPDX-License-Identifier: MIT
// Renderer threads, PNG files, and the tables and settings beside them.
#include "daemon/simulated_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <future>
#include <optional>

#include "calibration/light_field/light_field_calibration.hpp"
#include "core/clock.hpp"
#include "daemon/progress.hpp"
#include "daemon/simulated_files.hpp"
#include "daemon/truth_writer.hpp"
#include "replay/image_file.hpp"
#include "simulation/render_light_field.hpp"

namespace rptv {

namespace fs = std::filesystem;

SimulatedRunFiles::SimulatedRunFiles(const fs::path& folder)
    : frames(folder / "frames"),
      frame_times(frames / "frames.csv"),
      truth(folder / "truth.csv"),
      volume_truth(folder / "volume_truth.csv"),
      white(folder / "white.png"),
      white_stopped(folder / "white_stopped.png"),
      dark(folder / "dark.png"),
      background(folder / "background.png"),
      calibration(folder / "calibration.toml"),
      scenario(folder / "scenario.toml"),
      rig(folder / "rig.toml") {}

fs::path SimulatedRunFiles::frame(std::uint64_t index) const { return frames / fmt::format("frame_{:05}.png", index); }

namespace {

class Frames {
 public:
  Frames(const ScenarioSettings& scenario, const SimulatedRunFiles& files)
      : scenario_(scenario), files_(files), tracers_(scenario), truth_(files.truth), progress_("simulate", count()) {}

  /// Throws the first error of any thread.
  void write(unsigned threads) {
    const LightFieldRenderer first(scenario_);
    on_frames(count(), threads,
              [this, renderer = first, pixels = std::vector<std::byte>(first.shape().bytes())](
                  std::uint64_t frame) mutable { write_frame(renderer, frame, pixels); });
    truth_.close();
  }

  void report(SimulatedRunReport& report) const {
    const auto frames = static_cast<double>(scenario_.frames);
    report.bytes = bytes_;
    report.rays = rays_;
    report.particles_per_frame = static_cast<double>(truth_.lit()) / frames;
    report.in_view_per_frame = static_cast<double>(truth_.in_view()) / frames;
  }

 private:
  std::uint64_t count() const noexcept { return static_cast<std::uint64_t>(scenario_.frames); }

  void write_frame(LightFieldRenderer& renderer, std::uint64_t frame, std::span<std::byte> pixels) {
    const auto tracers = tracers_.lit(frame);
    renderer.render(tracers, frame, pixels);
    truth_.deliver(frame, truth_records(renderer, tracers, frame, tracers_.time_s(frame)));
    write_png(files_.frame(frame), {pixels.data(), renderer.shape()}, renderer.bits());
    bytes_ += fs::file_size(files_.frame(frame));
    rays_ += tracers.size() * renderer.rays();
    progress_.advance();
  }

  const ScenarioSettings& scenario_;
  const SimulatedRunFiles& files_;
  const Tracers tracers_;
  TruthWriter truth_;
  Progress progress_;
  std::atomic<std::uint64_t> bytes_{0}, rays_{0};
};

void write_white(const ScenarioSettings& scenario, const fs::path& file) {
  constexpr double kPeak = 0.7;  // of full scale
  LightFieldRenderer renderer(scenario);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  renderer.render_white(kPeak, pixels);
  write_png(file, {pixels.data(), renderer.shape()}, renderer.bits());
}

void write_still_images(const ScenarioSettings& scenario, const SimulatedRunFiles& files) {
  constexpr double kStoppedDown = 0.25;  // of the working aperture's diameter
  auto stopped =
      std::async(std::launch::async, [&] { write_white(stopped_down(scenario, kStoppedDown), files.white_stopped); });
  write_white(scenario, files.white);
  stopped.get();
  const Exposure exposure(scenario);
  std::vector<std::byte> pixels(exposure.shape().bytes());
  const ImageView view{pixels.data(), exposure.shape()};
  exposure.mean_without_light(pixels);
  write_png(files.background, view, static_cast<std::uint32_t>(scenario.camera.bits));
  exposure.expose_dark(pixels);
  write_png(files.dark, view, static_cast<std::uint32_t>(scenario.camera.bits));
}

}  // namespace

SimulatedRunReport write_simulated_run(const ScenarioSettings& wanted, const SimulatedRunOptions& options) {
  const std::int64_t start_ns = host_now_ns();
  check_scenario(wanted, "scenario");
  const LightFieldOptics optics(wanted);
  ScenarioSettings scenario = wanted;
  scenario.seeding.particles = optics.particles_in_box();
  const SimulatedRunFiles files(options.folder);
  make_folder(files.frames);
  remove_frames(files.frames);
  SimulatedRunReport report;
  report.frames = static_cast<std::uint64_t>(scenario.frames);
  write_text(files.scenario, scenario_toml(scenario));
  write_light_field_calibration(optics.calibration(), files.calibration);
  write_text(files.rig, rig_toml(scenario));
  write_times(scenario, files.frame_times);
  write_volume_truth(files.volume_truth, scenario, optics);
  write_still_images(scenario, files);
  const std::int64_t frames_ns = host_now_ns();
  Frames frames(scenario, files);
  frames.write(options.threads);
  frames.report(report);
  report.frames_elapsed_s = 1e-9 * static_cast<double>(host_now_ns() - frames_ns);
  report.elapsed_s = 1e-9 * static_cast<double>(host_now_ns() - start_ns);
  return report;
}

}  // namespace rptv
