// SPDX-License-Identifier: MIT
// Ours beside refocusing, MART and Richardson-Lucy: one telecentric scene in the seed's large volume, one run.
#include <algorithm>
#include <iomanip>
#include <ostream>

#include "reconstruct/light_field/coarse_maxima.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/light_field/pixels_to_rays.hpp"
#include "reconstruct/lit_pixels.hpp"
#include "tests/bench/baselines.hpp"
#include "tests/bench/contest.hpp"
#include "tests/bench/light_field_bench.hpp"
#include "tests/reconstruct/light_field/painted_image.hpp"

namespace rptv::bench {

namespace {

constexpr double kHalfZ = 18.75, kRadiusMm = 0.0375, kThreshold = 50;
constexpr std::size_t kParticles = 500;
constexpr int kMartIterations = 5, kLucyIterations = 10;

// 400x200 lenslets and voxels; the pupil so far away that the point spread is the same everywhere, as deconvolution
// needs it.
LightFieldCalibration telecentric() {
  auto camera = testing::small_camera(4160, 2080);
  camera.sensor.pixel_um = 12;
  camera.lenslets.rotation_deg = 0, camera.lenslets.offset_um = {62.5, 62.5};
  camera.lens.exit_pupil_mm = 1e5;
  return camera;
}

LightFieldSettings settings_of_scene() {
  LightFieldSettings settings;
  settings.threshold = kThreshold, settings.particle_radius_um = 15, settings.space = "image";
  settings.volume_x_mm = {-25, 25}, settings.volume_y_mm = {-12.5, 12.5}, settings.volume_z_mm = {-kHalfZ, kHalfZ};
  return settings;
}

VoxelGrid grid_of(std::int32_t planes) {
  VoxelGrid grid;
  grid.size_x = 400, grid.size_y = 200, grid.planes = planes;
  grid.step_x_mm = grid.step_y_mm = 0.125F, grid.step_z_mm = static_cast<float>(2 * kHalfZ / planes);
  grid.first_x_mm = -24.9375F, grid.first_y_mm = -12.4375F;
  grid.first_z_mm = static_cast<float>(-kHalfZ) + grid.step_z_mm / 2;
  return grid;
}

struct Scene {
  LightFieldCalibration camera = telecentric();
  testing::PaintedImage image{camera};
  std::vector<Point> truth;
  LensletLattice lattice{camera};
  PixelsToRays pixels_to_rays{camera, lattice, 1};
  Rays rays{262144, lattice.size()};
  std::vector<float> grey;

  Scene() {
    for (const auto& p : testing::scatter(kParticles, 24, 11.5, -17, 17, 0.3, 11)) {
      image.paint(p, kRadiusMm);
      truth.push_back({p.x, p.y, p.z});
    }
    std::vector<std::uint32_t> lit(262144);
    lit.resize(find_lit_pixels(image.view(), DarkLimit(image.view().shape, 0, kThreshold), lit));
    pixels_to_rays.convert(lit, rays);
    for (std::size_t i = 0; i < rays.size; ++i) grey.push_back(image.pixels()[lit[rays.pixel[i]]]);
  }
};

struct Row {
  std::size_t contender;
  Score score;
};

// The baselines are given the rays; so the last ratio is to our points without what it takes us to make the rays.
void print(std::ostream& out, const Contest& contest, const std::vector<Row>& rows) {
  const double candidates_ms = contest.median_ms(0), points_ms = contest.median_ms(1), once_ms = contest.median_ms(2);
  const double from_rays_ms = once_ms - contest.median_ms(3);
  out << "    pixels to rays " << std::fixed << std::setprecision(2) << contest.median_ms(3) << " ms\n"
      << std::setw(62) << "median ms" << std::setw(12) << "/candidates" << std::setw(9) << "/points" << std::setw(11)
      << "/one round" << std::setw(15) << "/the same, rays" << std::setw(7) << "found" << std::setw(8) << "ghosts"
      << std::setw(10) << "error mm" << std::setw(12) << "aside mm\n";
  for (const auto& [i, score] : rows)
    out << "    " << std::left << std::setw(48) << contest.name(i) << std::right << std::fixed << std::setprecision(2)
        << std::setw(10) << contest.median_ms(i) << std::setprecision(1) << std::setw(12)
        << contest.median_ms(i) / candidates_ms << std::setw(9) << contest.median_ms(i) / points_ms << std::setw(11)
        << contest.median_ms(i) / once_ms << std::setw(15) << contest.median_ms(i) / from_rays_ms << std::setw(7)
        << score.found << std::setw(8) << score.ghosts << std::setprecision(3) << std::setw(10) << score.mean_error_mm
        << std::setw(11) << score.lateral_mm << '\n';
}

}  // namespace

void bench_baselines(std::ostream& out, const LightFieldBenchOptions& options) {
  const Scene scene;
  const std::size_t n = scene.truth.size();
  const VoxelGrid full = grid_of(150);
  const double slope = scene.pixels_to_rays.slope_half_range();
  const VoxelGrid few = grid_of(static_cast<std::int32_t>(std::ceil(2 * kHalfZ * slope / 0.125)));
  RayCounter counter(few, scene.rays.capacity(), 1);
  CoarseMaxima maxima(few, 1);
  std::vector<Candidate> candidates;
  candidates.reserve(100'000);
  LightField light_field(settings_of_scene(), scene.camera, {});
  LightFieldSettings one_round = settings_of_scene();
  one_round.explain_rounds = 1;
  LightField light_field_once(one_round, scene.camera, {});
  const std::uint16_t least = light_field.min_count();
  Particles found(4096), found_once(4096);
  Rays rays(262144, scene.lattice.size());
  std::vector<std::uint32_t> lit(262144);
  VoxelVolume stack(full), nearest(full), bilinear(full), deconvolved(full);
  RichardsonLucy lucy(point_spread(full, 0.5 / scene.camera.lens.image_f_number));
  Contest contest;
  contest.add("ours, rays to candidates", [&] {
    candidates.clear();
    counter.count(scene.rays, {}, least);
    maxima.find(counter, least, candidates);
  });
  contest.add("ours, pixels to points with covariance", [&] { light_field.reconstruct(scene.image.view(), found); });
  contest.add("ours, the same with one round", [&] { light_field_once.reconstruct(scene.image.view(), found_once); });
  const DarkLimit limit(scene.image.view().shape, 0, kThreshold);
  contest.add("ours, pixels to rays", [&] {
    const std::size_t count = find_lit_pixels(scene.image.view(), limit, lit);
    scene.pixels_to_rays.convert({lit.data(), count}, rays);
  });
  const double views = 73;
  contest.add("synthetic refocusing", [&] { refocus(scene.rays, scene.grey, views, stack); });
  contest.add("MART nearest, 5 iterations", [&] { mart(scene.rays, scene.grey, false, kMartIterations, nearest); });
  contest.add("MART bilinear, 5 iterations", [&] { mart(scene.rays, scene.grey, true, kMartIterations, bilinear); });
  contest.add("Richardson-Lucy of the stack, 10 iterations", [&] { lucy.run(stack, kLucyIterations, deconvolved); });
  contest.run(std::clamp(options.rounds / 3, 1, 5));
  std::vector<Point> by_count;
  const auto points_of = [](const Particles& particles) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < particles.size(); ++i)
      points.push_back({particles.x_mm[i], particles.y_mm[i], particles.z_mm[i]});
    return points;
  };
  for (const auto& c : candidates) by_count.push_back({c.x_mm, c.y_mm, c.z_mm});
  out << "\nreconstruction of " << n << " particles in 400x200x150 voxels from " << scene.rays.size
      << " rays (lit pixels of a 4160x2080 image), 1 thread;\nthe baselines start from rays; of their volumes the " << n
      << " brightest maxima count, placed by parabolas\n";
  print(out, contest,
        {{0, score_points(by_count, scene.truth)},
         {1, score_points(points_of(found), scene.truth)},
         {2, score_points(points_of(found_once), scene.truth)},
         {4, score_points(brightest_maxima(stack, n), scene.truth)},
         {5, score_points(brightest_maxima(nearest, n), scene.truth)},
         {6, score_points(brightest_maxima(bilinear, n), scene.truth)},
         {7, score_points(brightest_maxima(deconvolved, n), scene.truth)}});
}

}  // namespace rptv::bench
