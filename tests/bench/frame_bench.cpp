// SPDX-License-Identifier: MIT
// Whole frames through the light-field stage.
#include <chrono>
#include <ctime>
#include <iomanip>
#include <ostream>

#include "reconstruct/light_field/coarse_maxima.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/light_field/light_field_volume.hpp"
#include "reconstruct/light_field/pixels_to_rays.hpp"
#include "reconstruct/lit_pixels.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/light_field_bench.hpp"
#include "tests/reconstruct/light_field/painted_image.hpp"
#include "tests/reconstruct/shared_data.hpp"

namespace rptv::bench {

namespace {

double process_cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) * 1e3 + static_cast<double>(now.tv_nsec) * 1e-6;
}

double wall_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The steps before the fit, each by itself, and what is left of the whole: fits, claims, later rounds.
void bench_stages(std::ostream& out, const std::string& name, const LightFieldSettings& settings,
                  const LightFieldCalibration& calibration, const ImageView& image, int rounds) {
  const LensletLattice lattice(calibration);
  const PixelsToRays pixels_to_rays(calibration, lattice, 1);
  const VoxelGrid grid = make_grid(settings, calibration, pixels_to_rays.slope_half_range());
  const DarkLimit limit(image.shape, settings.background, settings.threshold);
  LightField light_field(settings, calibration, {});
  std::vector<std::uint32_t> lit(image.shape.pixels());
  Rays rays(lit.size(), lattice.size());
  RayCounter counter(grid, rays.capacity(), 1);
  CoarseMaxima maxima(grid, 1);
  std::vector<Candidate> candidates;
  candidates.reserve(100'000);
  Particles found(4096);
  std::size_t count = 0;
  Contest contest;
  contest.add("lit pixels", [&] { count = find_lit_pixels(image, limit, lit); });
  contest.add("pixels to rays", [&] { pixels_to_rays.convert({lit.data(), count}, rays); });
  contest.add("ray counter, " + std::to_string(grid.planes) + " planes", [&] { counter.count(rays, {}, 1); });
  contest.add("maxima", [&] { candidates.clear(), maxima.find(counter, light_field.min_count(), candidates); });
  contest.add("whole", [&] { light_field.reconstruct(image, found); });
  contest.run(rounds);
  double rest_ms = contest.median_ms(contest.size() - 1);
  out << "    " << name << ", 1 thread, cpu ms:" << std::fixed << std::setprecision(2);
  for (std::size_t i = 0; i + 1 < contest.size(); rest_ms -= contest.median_ms(i++))
    out << ' ' << contest.name(i) << ' ' << contest.median_ms(i) << ';';
  out << " fits, claims and later rounds " << rest_ms << '\n';
}

void bench_one(std::ostream& out, const std::string& name, LightFieldSettings settings,
               const LightFieldCalibration& calibration, const ImageView& image, int rounds) {
  bench_stages(out, name, settings, calibration, image, rounds);
  Particles found(4096);
  for (const std::int64_t threads : {1, 2}) {
    settings.threads = threads;
    LightField light_field(settings, calibration, {});
    light_field.reconstruct(image, found);
    std::vector<double> cpu, wall;
    for (int round = 0; round < rounds; ++round) {
      const double cpu_ms = process_cpu_ms(), begin_ms = wall_ms();
      light_field.reconstruct(image, found);
      cpu.push_back(process_cpu_ms() - cpu_ms), wall.push_back(wall_ms() - begin_ms);
    }
    const auto& counts = light_field.counts();
    const double least_ms = *std::min_element(wall.begin(), wall.end());
    out << "    " << std::left << std::setw(24) << name << std::right << std::setw(8) << threads << std::setw(9)
        << counts.lit_pixels << std::setw(11) << found.size() << std::setw(8) << counts.rounds << std::fixed
        << std::setprecision(2) << std::setw(10) << median(cpu) << std::setw(10) << median(wall) << std::setw(10)
        << least_ms << std::setprecision(0) << std::setw(8) << 1e3 / median(wall) << std::setw(10) << 1e3 / least_ms
        << '\n';
  }
}

LightFieldSettings wall_settings() {
  LightFieldSettings settings;
  settings.threshold = 5, settings.particle_radius_um = 15, settings.volume_z_mm = {-36, 20};
  settings.slope_blur_um = 0.33 * 0.532 * 3750 / 125;
  return settings;
}

}  // namespace

void bench_frames(std::ostream& out, const LightFieldBenchOptions& options) {
  out << "\nwhole reconstruction of a 2048x1536 frame\n"
      << "    image                    threads   pixels  particles  rounds    cpu ms   wall ms  least ms     fps  best "
         "fps\n";
  const auto camera = testing::small_camera(2048, 1536);
  testing::PaintedImage painted(camera);
  for (const auto& p : testing::scatter(180, 8, 6, -30, 15, 0.25, 5)) painted.paint(p, 0.0375);
  bench_one(out, "painted", wall_settings(), camera, painted.view(), options.rounds);
  const std::string folder = RPTV_SOURCE_DIR "/tests/reconstruct/data/";
  if (const auto wall = testing::shared_set("lf-wall")) {
    const testing::DecodedImage image(*wall / "frame_000.png");
    bench_one(out, "lf-wall frame 0", wall_settings(),
              read_light_field_calibration(folder + "lf_wall_calibration.toml"), image.view(), options.rounds);
  }
  if (const auto macro = testing::shared_set("lf-macro")) {
    LightFieldSettings settings;
    settings.threshold = 15, settings.particle_radius_um = 30, settings.volume_z_mm = {-16, 16};
    const testing::DecodedImage image(*macro / "combined.png");
    bench_one(out, "lf-macro combined", settings, read_light_field_calibration(folder + "lf_macro_calibration.toml"),
              image.view(), options.rounds);
  }
}

}  // namespace rptv::bench
