// SPDX-License-Identifier: MIT
// Threads over frames, all cameras of a frame in one; the truth afterwards, in order.
#include "daemon/simulated_views.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "core/clock.hpp"
#include "core/csv.hpp"
#include "daemon/progress.hpp"
#include "daemon/simulated_files.hpp"
#include "replay/image_file.hpp"
#include "simulation/challenge_rig.hpp"
#include "simulation/lpt_points.hpp"
#include "simulation/render_views.hpp"

namespace rptv {

namespace fs = std::filesystem;

namespace {

/// Replay finds cameras by this name, whatever the rig calls them.
fs::path camera_folder(const fs::path& folder, std::size_t camera) {
  return folder / "frames" / fmt::format("cam{}", camera);
}

struct FramesOfRig {
  const ScenarioSettings& scenario;
  const fs::path& folder;
  const Tracers& tracers;
  Progress& progress;
  std::atomic<std::uint64_t>& bytes;
  std::vector<ViewRenderer> renderers;
  std::vector<std::byte> pixels{};

  void operator()(std::uint64_t frame) {
    const auto lit = tracers.lit(frame);
    std::vector<LptPoint> points;
    for (const Tracer& tracer : lit) points.push_back({{tracer.position.x, tracer.position.y, tracer.position.z}, {}});
    for (std::size_t k = 0; k < renderers.size(); ++k) {
      pixels.resize(renderers[k].shape().bytes());
      renderers[k].render(lit, frame, pixels);
      const fs::path file = camera_folder(folder, k) / fmt::format("frame_{:05}.png", frame);
      write_png(file, {pixels.data(), renderers[k].shape()}, static_cast<std::uint32_t>(scenario.camera.bits));
      bytes += fs::file_size(file);
      for (std::size_t i = 0; i < points.size(); ++i) points[i].pixels.push_back(renderers[k].views()[i].pixel);
    }
    write_text(folder / "truth" / fmt::format("points_{:05}.txt", frame), lpt_points_text(points));
    progress.advance();
  }
};

std::string truth_header(std::size_t cameras) {
  std::string header = "frame,particle,x,y,z,vx,vy,vz,residual,age,t,in_view";
  for (std::size_t k = 0; k < cameras; ++k) header += fmt::format(",x{0}_px,y{0}_px", k);
  return header;
}

void write_truth(const std::vector<ViewRenderer>& renderers, const Tracers& tracers, std::uint64_t frames,
                 const fs::path& file, SimulatedRunReport& report) {
  CsvWriter csv(file, truth_header(renderers.size()));
  const std::size_t wanted = std::min<std::size_t>(3, renderers.size());
  for (std::uint64_t frame = 0; frame < frames; ++frame)
    for (const Tracer& tracer : tracers.lit(frame)) {
      const TruthRow row = truth_row(tracer, frame, tracers.time_s(frame));
      std::vector<ViewOfTracer> views;
      for (const ViewRenderer& renderer : renderers) views.push_back(renderer.view_of(tracer));
      const auto seen = static_cast<std::size_t>(
          std::count_if(views.begin(), views.end(), [](const ViewOfTracer& view) { return view.in_view; }));
      csv.index(row.frame).index(row.particle);
      for (const double value : {row.x_mm, row.y_mm, row.z_mm, row.vx_mm_s, row.vy_mm_s, row.vz_mm_s, row.residual_mm})
        csv.number(value);
      csv.index(row.age).number(row.t_s).index(seen >= wanted ? 1 : 0);
      for (const ViewOfTracer& view : views) csv.number(view.pixel[0]).number(view.pixel[1]);
      csv.end_row();
      report.particles_per_frame += 1, report.in_view_per_frame += seen >= wanted ? 1 : 0;
    }
  csv.close();
  report.particles_per_frame /= static_cast<double>(frames), report.in_view_per_frame /= static_cast<double>(frames);
}

void make_folders(const fs::path& folder, std::size_t cameras) {
  for (std::size_t k = 0; k < Rig::kMostCameras; ++k) {
    if (k < cameras) make_folder(camera_folder(folder, k));
    if (k < cameras || fs::exists(camera_folder(folder, k))) remove_frames(camera_folder(folder, k));
    std::error_code error;
    if (k >= cameras) fs::remove(camera_folder(folder, k), error);  // of an earlier run; stays when it holds more
  }
  make_folder(folder / "truth");
}

}  // namespace

SimulatedRunReport write_simulated_views(const ScenarioSettings& wanted, const SimulatedRunOptions& options) {
  const std::int64_t start_ns = host_now_ns();
  check_scenario(wanted, "scenario");
  const Rig rig = rig_of(wanted);
  const ScenarioSettings scenario = fitted_to_rig(wanted, rig);
  make_folders(options.folder, rig.cameras.size());
  write_rig(rig, options.folder / "cameras.toml");
  write_text(options.folder / "scenario.toml", scenario_toml(wanted));
  write_times(scenario, options.folder / "frames" / "frames.csv");
  const Tracers tracers(scenario);
  std::vector<ViewRenderer> renderers;
  for (std::size_t k = 0; k < rig.cameras.size(); ++k) renderers.emplace_back(scenario, rig.cameras[k].model, k);
  SimulatedRunReport report;
  report.frames = static_cast<std::uint64_t>(scenario.frames);
  const std::int64_t frames_ns = host_now_ns();
  {
    Progress progress("simulate", report.frames);
    std::atomic<std::uint64_t> bytes{0};
    on_frames(report.frames, options.threads,
              FramesOfRig{scenario, options.folder, tracers, progress, bytes, renderers});
    report.bytes = bytes;
  }
  report.frames_elapsed_s = 1e-9 * static_cast<double>(host_now_ns() - frames_ns);
  write_truth(renderers, tracers, report.frames, options.folder / "truth.csv", report);
  report.elapsed_s = 1e-9 * static_cast<double>(host_now_ns() - start_ns);
  return report;
}

}  // namespace rptv
