// SPDX-License-Identifier: MIT
// Explaining away on the device, run on the CPU, against ExplainAway: the same particles bit for bit, or "unsure".
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cstring>

#include "reconstruct/light_field/explain_away.hpp"
#include "reconstruct/light_field/explainer_cuda.hpp"
#include "reconstruct/light_field/pixels_to_rays.hpp"
#include "tests/reconstruct/light_field/device_copies.hpp"
#include "tests/reconstruct/light_field/painted_image.hpp"

namespace rptv {
namespace {

using testing::on_device;

constexpr std::size_t kMostRays = 6000, kMostCandidates = 90;

/// Rays of crowded particles and of noise, in a small camera, and where particles may be.
struct Scene {
  Scene(unsigned seed, int particles, double apart_mm, std::size_t hypotheses)
      : camera(testing::small_camera(200, 150)),
        lattice(camera),
        pixels_to_rays(camera, lattice, hypotheses),
        window(lattice, 1 / camera.lens.exit_pupil_mm, pixels_to_rays.slope_half_range()),
        rays(kMostRays, lattice.size()) {
    std::mt19937 random(seed);
    testing::PaintedImage image(camera);
    for (const auto& p : testing::scatter(particles, 0.8, 0.6, -16, 12, apart_mm, seed)) {
      image.paint(p, 0.0375);
      std::normal_distribution<double> off;
      for (int near = 0; near < 3; ++near)
        candidates.push_back({static_cast<float>(p.x + 0.04 * off(random)),
                              static_cast<float>(p.y + 0.04 * off(random)), static_cast<float>(p.z + 4 * off(random)),
                              static_cast<std::uint32_t>(random() % 300)});
    }
    std::vector<std::uint32_t> lit;
    for (std::uint32_t i = 0; i < image.pixels().size(); ++i)
      if (image.pixels()[i] != 0 || random() % 40 == 0) lit.push_back(i);
    pixels_to_rays.convert(lit, rays);
    explain.fit.gate = {lattice.rotation_cosine(), lattice.rotation_sine(), 0.1, 0.0012};
    explain.fit.start_margin_mm = 0.09, explain.fit.start_depth_mm = 4, explain.fit.pitch_mm = 0.125;
    explain.fit.slope_variance = 4e-7, explain.fit.min_support = 10;
    explain.lowest_z_mm = -18, explain.highest_z_mm = 14;
    explain.max_particles = 100, explain.max_candidates = kMostCandidates, explain.max_rays = kMostRays;
  }
  LightFieldCalibration camera;
  LensletLattice lattice;
  PixelsToRays pixels_to_rays;
  RayWindow window;
  Rays rays;
  std::vector<Candidate> candidates;
  ExplainOptions explain;
};

/// ExplainerCuda with a scene's rays, which are copied once.
class OnDevice {
 public:
  explicit OnDevice(const Scene& scene)
      : scene_(scene),
        ray_(on_device(stream_, scene.rays.ray)),
        pixel_(on_device(stream_, scene.rays.pixel)),
        same_pixel_(on_device(stream_, scene.rays.same_pixel)),
        first_(on_device(stream_, scene.rays.first_of_lenslet)),
        sizes_(on_device<std::uint32_t>(
            stream_, {static_cast<std::uint32_t>(scene.rays.size), static_cast<std::uint32_t>(scene.rays.pixels), 0})),
        candidate_(kMostCandidates),
        explainer_({shape_, scene.lattice, scene.pixels_to_rays, grid_, scene.window, scene.explain, kMostRays,
                    kMostCandidates, 1},
                   {ray_.data(), pixel_.data(), same_pixel_.data(), first_.data(), sizes_.data(), sizes_.data() + 1,
                    kMostRays, scene.lattice.size()},
                   {candidate_.data(), sizes_.data() + 2, kMostCandidates, nullptr, nullptr, nullptr}) {
    particles_.found.reserve(scene.explain.max_particles);
  }

  /// Rounds of so many candidates each; false: unsure. Without `wait`, what is read is older.
  bool explain(const std::vector<std::size_t>& ends, bool wait = true) {
    EXPECT_TRUE(explainer_.begin(stream_));
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
      const auto size = static_cast<std::uint32_t>(end - begin);
      EXPECT_TRUE(stream_.upload(candidate_.data(), &scene_.candidates[begin], size * sizeof(Candidate)) &&
                  stream_.upload(sizes_.data() + 2, &size, sizeof size) && explainer_.begin_round(stream_) &&
                  explainer_.explain(stream_))
          << cuda_host::last_fault();
      begin = end;
    }
    EXPECT_TRUE(explainer_.queue_settle(stream_) && (!wait || stream_.synchronize())) << cuda_host::last_fault();
    explainer_.read(particles_);
    EXPECT_TRUE(stream_.synchronize());
    return particles_.sure;
  }
  const std::vector<FittedParticle>& found() const { return particles_.found; }

 private:
  const Scene& scene_;
  const ImageShape shape_;
  const VoxelGrid grid_;
  CudaStream stream_;
  DeviceArray<Ray> ray_;
  DeviceArray<std::uint32_t> pixel_, same_pixel_, first_, sizes_;
  DeviceArray<Candidate> candidate_;
  ExplainerCuda explainer_;
  DeviceParticles particles_;
};

std::vector<FittedParticle> explain_by_cpu(const Scene& scene, const std::vector<std::size_t>& ends) {
  ExplainAway explain(scene.window, scene.explain);
  explain.begin(scene.rays);
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    explain.explain(scene.rays, std::span(scene.candidates).subspan(begin, end - begin));
    begin = end;
  }
  explain.settle(scene.rays);
  return {explain.particles().begin(), explain.particles().end()};
}

bool same(const std::vector<FittedParticle>& a, const std::vector<FittedParticle>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const FittedParticle& p, const FittedParticle& q) {
    return std::memcmp(&p.at, &q.at, sizeof p.at) == 0 && p.support == q.support && p.residual_mm == q.residual_mm &&
           std::memcmp(&p.covariance, &q.covariance, sizeof p.covariance) == 0;
  });
}

RC_GTEST_PROP(CudaExplainAway, finds_the_particles_of_the_cpu_in_crowds, ()) {
  using rc::gen::element;
  using rc::gen::inRange;
  Scene scene(*inRange(0U, 1U << 20), *inRange(1, 25), *element(0.0, 0.06, 0.15), *element<std::size_t>(1, 3));
  scene.explain.fit.start_margin_mm = *element(0.01, 0.09);
  const std::size_t all = scene.candidates.size();
  const std::vector<std::size_t> rounds{all * *inRange<std::size_t>(0, 5) / 4, all};
  cuda_host::set_schedule_seed(*element<std::uint64_t>(0, 1, 5));
  OnDevice device(scene);
  const bool sure = device.explain(rounds);
  RC_CLASSIFY(!sure, "unsure");
  RC_ASSERT(same(device.found(), sure ? explain_by_cpu(scene, rounds) : std::vector<FittedParticle>{}));
}

TEST(CudaExplainAway, finds_the_particles_of_the_cpu_frame_after_frame) {
  Scene scene(7, 20, 0.1, 1);
  OnDevice device(scene);
  for (const std::size_t candidates : {scene.candidates.size(), std::size_t{9}, std::size_t{0}}) {
    ASSERT_TRUE(device.explain({candidates}));
    EXPECT_TRUE(same(device.found(), explain_by_cpu(scene, {candidates}))) << candidates;
    EXPECT_EQ(device.found().empty(), candidates == 0);
  }
}

TEST(CudaExplainAway, shows_in_tests_when_nobody_waits_for_it) {
  Scene scene(7, 20, 0.1, 1);
  OnDevice device(scene);
  device.explain({scene.candidates.size()}, false);
  EXPECT_TRUE(device.found().empty());
  device.explain({scene.candidates.size()});
  EXPECT_GT(device.found().size(), 10U);
}

TEST(CudaExplainAway, is_unsure_when_fits_lead_away_from_the_rays_that_they_looked_at) {
  int unsure = 0, differ = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Scene scene(seed, 12, 0.06, 1);
    scene.explain.fit.start_margin_mm = 0.005, scene.explain.fit.start_depth_mm = 0;
    OnDevice device(scene);
    const bool sure = device.explain({scene.candidates.size()});
    unsure += sure ? 0 : 1;
    differ += sure && !same(device.found(), explain_by_cpu(scene, {scene.candidates.size()})) ? 1 : 0;
  }
  EXPECT_GT(unsure, 0);
  EXPECT_EQ(differ, 0);
}

TEST(CudaExplainAway, is_unsure_where_there_is_no_room) {
  Scene few_particles(3, 12, 0.2, 1), wide_gate(3, 12, 0.2, 1);
  few_particles.explain.max_particles = 5;
  EXPECT_FALSE(OnDevice(few_particles).explain({few_particles.candidates.size()}));
  wide_gate.explain.fit.gate.half_width_mm = 5;
  ASSERT_GT(wide_gate.rays.size, 4096U);
  EXPECT_FALSE(OnDevice(wide_gate).explain({3}));
}

}  // namespace
}  // namespace rptv
