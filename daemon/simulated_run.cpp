// SPDX-License-Identifier: MIT
// Renderer threads, PNG files, and the tables and settings beside them.
#include "daemon/simulated_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>

#include "calibration/light_field_calibration.hpp"
#include "core/clock.hpp"
#include "core/csv.hpp"
#include "core/error.hpp"
#include "core/tables.hpp"
#include "daemon/progress.hpp"
#include "replay/image_file.hpp"
#include "simulation/render_light_field.hpp"

namespace rptv {

namespace fs = std::filesystem;

SimulatedRunFiles::SimulatedRunFiles(const fs::path& folder)
    : frames(folder / "frames"),
      frame_times(frames / "frames.csv"),
      truth(folder / "truth.csv"),
      white(folder / "white.png"),
      background(folder / "background.png"),
      calibration(folder / "calibration.toml"),
      scenario(folder / "scenario.toml"),
      rig(folder / "rig.toml") {}

fs::path SimulatedRunFiles::frame(std::uint64_t index) const { return frames / fmt::format("frame_{:05}.png", index); }

namespace {

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw Error(
        error == std::errc::permission_denied ? ExitCode::permission : ExitCode::io,
        fmt::format("{}: cannot create the folder ({}); choose another with --out", folder.string(), error.message()));
}

/// Frames of an earlier, longer run would be replayed behind these.
void remove_frames(const fs::path& frames) {
  for (const auto& entry : fs::directory_iterator(frames)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("frame_") && name.ends_with(".png")) fs::remove(entry.path());
  }
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out << text;
  if (!out.flush()) throw Error(ExitCode::io, file.string() + ": cannot write; check the disk and the permissions");
}

class Frames {
 public:
  Frames(const ScenarioSettings& scenario, const SimulatedRunFiles& files)
      : scenario_(scenario), files_(files), tracers_(scenario), progress_("simulate", count()) {}

  /// Throws the first error of any thread.
  void write(unsigned threads) {
    const LightFieldRenderer first(scenario_);
    std::vector<std::thread> workers;
    for (unsigned i = 0; i < threads; ++i) workers.emplace_back([this, first] { work(first); });
    for (auto& worker : workers) worker.join();
    if (error_) std::rethrow_exception(error_);
  }
  std::uint64_t bytes() const noexcept { return bytes_; }

 private:
  std::uint64_t count() const noexcept { return static_cast<std::uint64_t>(scenario_.frames); }

  void work(LightFieldRenderer renderer) try {
    std::vector<std::byte> pixels(renderer.shape().bytes());
    for (std::uint64_t frame = next_++; frame < count() && !stopped_; frame = next_++) {
      renderer.render(tracers_.lit(frame), frame, pixels);
      write_png(files_.frame(frame), {pixels.data(), renderer.shape()}, renderer.bits());
      bytes_ += fs::file_size(files_.frame(frame));
      progress_.advance();
    }
  } catch (...) {
    const std::lock_guard lock(failing_);
    if (!error_) error_ = std::current_exception();
    stopped_ = true;
  }

  const ScenarioSettings& scenario_;
  const SimulatedRunFiles& files_;
  const Tracers tracers_;
  Progress progress_;
  std::atomic<std::uint64_t> next_{0}, bytes_{0};
  std::atomic<bool> stopped_{false};
  std::mutex failing_;
  std::exception_ptr error_;
};

void write_tables(const ScenarioSettings& scenario, const SimulatedRunFiles& files, SimulatedRunReport& report) {
  const Tracers tracers(scenario);
  const LightFieldRenderer renderer(scenario);
  CsvWriter times(files.frame_times, "frame,t");
  CsvWriter truth(files.truth, "frame,particle,x,y,z,vx,vy,vz,residual,age,t,in_view");
  std::uint64_t lit = 0, in_view = 0;
  for (std::uint64_t frame = 0; frame < report.frames; ++frame) {
    times.index(frame).number(tracers.time_s(frame)).end_row();
    for (const auto& tracer : tracers.lit(frame)) {
      const TruthRow row = truth_row(tracer, frame, tracers.time_s(frame));
      const bool seen = renderer.in_view(tracer.position);
      truth.index(frame).index(row.particle);
      for (const double value : {row.x_mm, row.y_mm, row.z_mm, row.vx_mm_s, row.vy_mm_s, row.vz_mm_s, row.residual_mm})
        truth.number(value);
      truth.index(row.age).number(row.t_s).index(seen).end_row();
      ++lit;
      in_view += seen;
    }
  }
  times.close();
  truth.close();
  report.particles_per_frame = static_cast<double>(lit) / static_cast<double>(report.frames);
  report.in_view_per_frame = static_cast<double>(in_view) / static_cast<double>(report.frames);
}

void write_still_images(const ScenarioSettings& scenario, const SimulatedRunFiles& files) {
  LightFieldRenderer renderer(scenario);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  const ImageView view{pixels.data(), renderer.shape()};
  renderer.render_background(pixels);
  write_png(files.background, view, renderer.bits());
  renderer.render_white(0.7, pixels);
  write_png(files.white, view, renderer.bits());
}

std::string toml_of(ScenarioSettings scenario) {
  FieldList list;
  scenario.fields(list);
  return to_toml(list, kScenarioSchema);
}

}  // namespace

SimulatedRunReport write_simulated_run(const ScenarioSettings& scenario, const SimulatedRunOptions& options) {
  const std::int64_t start_ns = host_now_ns();
  check_scenario(scenario, "scenario");
  const SimulatedRunFiles files(options.folder);
  make_folder(files.frames);
  remove_frames(files.frames);
  SimulatedRunReport report;
  report.frames = static_cast<std::uint64_t>(scenario.frames);
  write_text(files.scenario, toml_of(scenario));
  write_light_field_calibration(LightFieldOptics(scenario).calibration(), files.calibration);
  write_text(files.rig, rig_toml(scenario));
  write_tables(scenario, files, report);
  write_still_images(scenario, files);
  Frames frames(scenario, files);
  frames.write(options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency()));
  report.bytes = frames.bytes();
  report.elapsed_s = 1e-9 * static_cast<double>(host_now_ns() - start_ns);
  return report;
}

}  // namespace rptv
