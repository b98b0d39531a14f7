// SPDX-License-Identifier: MIT
// The light-field stage with the device, run on the CPU, against the stage without: the same particles, bit for bit.
#include "reconstruct/light_field/light_field_cuda.hpp"

#include <gtest/gtest.h>

#include "reconstruct/light_field/device_trial.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

using testing::paint;
using testing::PaintedImage;
using testing::scene;
using testing::small_camera;

LightFieldSettings small_settings() {
  LightFieldSettings settings = testing::small_settings();
  settings.max_rays = 12000, settings.max_particles = 100;  // idle threads take time here, too
  return settings;
}

std::unique_ptr<LightFieldDevice> make_cuda(const LightFieldDevicePlan& plan) {
  return std::make_unique<LightFieldCuda>(plan);
}

Particles find(LightField& light_field, const ImageView& image) {
  Particles found(512);
  light_field.reconstruct(image, found);
  return found;
}

void expect_same(const Particles& a, const Particles& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a.x_mm[i], b.x_mm[i]);
    EXPECT_EQ(a.y_mm[i], b.y_mm[i]);
    EXPECT_EQ(a.z_mm[i], b.z_mm[i]);
    EXPECT_EQ(a.support[i], b.support[i]);
    EXPECT_EQ(a.residual_mm[i], b.residual_mm[i]);
    EXPECT_EQ(a.covariance_mm2[i], b.covariance_mm2[i]);
  }
}

LightFieldCounts expect_same_over_frames(const LightFieldSettings& settings, const LightFieldCalibration& camera) {
  LightField cpu(settings, camera, {}), device(settings, camera, {}, make_cuda);
  const std::size_t bytes = cuda_host::device_bytes_in_use();
  for (unsigned seed = 1; seed <= 2; ++seed) {
    cuda_host::set_schedule_seed(seed);
    const PaintedImage image = paint(scene(seed));
    const Particles expected = find(cpu, image.view());
    EXPECT_GT(expected.size(), 2U);
    expect_same(find(device, image.view()), expected);
    EXPECT_EQ(device.counts().lit_pixels, cpu.counts().lit_pixels);
    EXPECT_EQ(device.counts().rays, cpu.counts().rays);
    EXPECT_EQ(device.counts().candidates, cpu.counts().candidates);
    EXPECT_EQ(device.counts().refused_pixels, cpu.counts().refused_pixels);
    EXPECT_EQ(device.counts().refused_candidates, cpu.counts().refused_candidates);
    EXPECT_FALSE(device.counts().device_failed);
    EXPECT_EQ(device.counts().rounds, cpu.counts().rounds);
  }
  EXPECT_EQ(cuda_host::device_bytes_in_use(), bytes);  // nothing per frame
  return device.counts();
}

TEST(LightFieldCuda, finds_the_particles_of_the_cpu) { expect_same_over_frames(small_settings(), small_camera()); }

TEST(LightFieldCuda, finds_them_where_sub_images_overlap) {
  auto settings = small_settings();
  settings.max_hypotheses = 3;
  auto camera = small_camera();
  camera.lens.image_f_number = 16;
  expect_same_over_frames(settings, camera);
}

TEST(LightFieldCuda, finds_them_with_a_background_that_follows_the_images) {
  auto settings = small_settings();
  settings.running_background = true;
  expect_same_over_frames(settings, small_camera());
}

TEST(LightFieldCuda, finds_them_when_what_is_left_of_the_image_is_searched_again) {
  auto settings = small_settings();
  settings.refine = true, settings.refine_rounds = 2;
  expect_same_over_frames(settings, small_camera());
}

TEST(LightFieldCuda, leaves_out_and_counts_what_the_cpu_leaves_out) {
  auto few_rays = small_settings(), few_candidates = small_settings();
  few_rays.max_rays = 1900;
  few_candidates.max_particles = 3, few_candidates.min_count = 5;
  EXPECT_GT(expect_same_over_frames(few_rays, small_camera()).refused_pixels, 0U);
  EXPECT_GT(expect_same_over_frames(few_candidates, small_camera()).refused_candidates, 0U);
}

TEST(LightFieldCuda, reads_frames_out_of_page_locked_memory_and_gives_it_back) {
  PaintedImage image = paint(scene(2));
  const auto memory = std::as_writable_bytes(std::span(image.pixels()));
  LightField cpu(small_settings(), small_camera(), {});
  for (int time = 0; time < 2; ++time) {
    LightField device(small_settings(), small_camera(), {}, make_cuda);
    EXPECT_TRUE(device.page_lock(memory));
    EXPECT_FALSE(device.page_lock(memory));  // it is already
    EXPECT_TRUE(cpu.page_lock(memory));      // needs none
    expect_same(find(device, image.view()), find(cpu, image.view()));
  }
}

/// The real device behind a fault of one step.
class FaultyDevice final : public LightFieldDevice {
 public:
  enum class Fault {
    fails_at_lit,
    fails_at_rays,
    fails_at_reading,
    fails_at_candidates,
    fails_at_particles,
    loses_a_candidate,
    moves_a_ray,
    moves_a_particle,
    is_never_sure
  };
  FaultyDevice(const LightFieldDevicePlan& plan, Fault fault) : device_(plan), fault_(fault) {}

  bool page_lock(std::span<std::byte> memory) noexcept override { return device_.page_lock(memory); }
  bool set_limit(const DarkLimit& limit) noexcept override { return device_.set_limit(limit); }
  bool find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit, std::size_t& found) noexcept override {
    return fault_ != Fault::fails_at_lit && device_.find_lit_pixels(image, lit, found);
  }
  bool find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept override {
    return fault_ != Fault::fails_at_rays && device_.find_rays(lit, rays, refused);
  }
  bool read_rays(Rays& rays) noexcept override {
    const bool done = fault_ != Fault::fails_at_reading && device_.read_rays(rays);
    if (fault_ == Fault::moves_a_ray) rays.ray[rays.size / 2].slope_x += 1e-7F;
    return done;
  }
  bool find_particles(std::uint16_t least, std::size_t rounds, DeviceParticles& particles) noexcept override {
    const bool done = fault_ != Fault::fails_at_particles && device_.find_particles(least, rounds, particles);
    spoil(particles);
    return done;
  }
  bool find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least, std::vector<Candidate>& candidates,
                       std::size_t& refused) noexcept override {
    const bool done =
        fault_ != Fault::fails_at_candidates && device_.find_candidates(taken, least, candidates, refused);
    if (fault_ == Fault::loses_a_candidate && !candidates.empty()) candidates.pop_back();
    return done;
  }
  bool submit(const ImageView& image, std::uint16_t least, std::size_t rounds) noexcept override {
    return fault_ != Fault::fails_at_lit && device_.submit(image, least, rounds);
  }
  bool collect(DeviceFrame& frame) noexcept override {
    const bool done = fault_ != Fault::fails_at_rays && fault_ != Fault::fails_at_particles && device_.collect(frame);
    spoil(frame.particles);
    return done;
  }

 private:
  void spoil(DeviceParticles& particles) const {
    if (fault_ == Fault::fails_at_reading || fault_ == Fault::fails_at_candidates || fault_ == Fault::is_never_sure)
      particles.sure = false;
    if (fault_ == Fault::moves_a_particle && !particles.found.empty()) particles.found.back().at.z += 1e-9;
  }

  LightFieldCuda device_;
  Fault fault_;
};

TEST(LightFieldDevice, that_fails_is_replaced_by_the_cpu_at_any_step) {
  using Fault = FaultyDevice::Fault;
  const PaintedImage image = paint(scene(4));
  LightField cpu(small_settings(), small_camera(), {});
  const Particles expected = find(cpu, image.view());
  for (const Fault fault : {Fault::fails_at_lit, Fault::fails_at_rays, Fault::fails_at_particles,
                            Fault::fails_at_reading, Fault::fails_at_candidates}) {
    LightField light_field(small_settings(), small_camera(), {}, [&](const LightFieldDevicePlan& plan) {
      return std::make_unique<FaultyDevice>(plan, fault);
    });
    for (int frame = 0; frame < 2; ++frame) expect_same(find(light_field, image.view()), expected);
    EXPECT_TRUE(light_field.counts().device_failed);
  }
}

/// The plan of a small camera, for a device alone.
struct SmallPlan {
  LightFieldCalibration camera = small_camera(200, 150);
  ImageShape shape{200, 150, 2};
  LensletLattice lattice{camera};
  PixelsToRays pixels_to_rays{camera, lattice, 1};
  VoxelGrid grid;
  RayWindow window{lattice, 1 / camera.lens.exit_pupil_mm, pixels_to_rays.slope_half_range()};
  ExplainOptions explain;
  LightFieldDevicePlan plan{shape, lattice, pixels_to_rays, grid, window, explain, 5000, 400, 1};
  SmallPlan() {
    grid.size_x = 15, grid.size_y = 11, grid.planes = 5;
    grid.step_x_mm = grid.step_y_mm = 0.125F, grid.step_z_mm = 8;
    grid.first_x_mm = -0.9F, grid.first_y_mm = -0.6F, grid.first_z_mm = -16;
    explain.fit.gate = {lattice.rotation_cosine(), lattice.rotation_sine(), 0.1, 0};
    explain.fit.start_margin_mm = 0.09, explain.fit.start_depth_mm = 8, explain.fit.pitch_mm = 0.125;
    explain.lowest_z_mm = -24, explain.highest_z_mm = 24;
    explain.max_particles = 100, explain.max_candidates = 400, explain.max_rays = 5000;
  }
};

TEST(LightFieldDevice, that_is_unsure_leaves_particles_to_the_cpu_and_is_asked_again) {
  const PaintedImage image = paint(scene(4));
  LightField cpu(small_settings(), small_camera(), {});
  LightField light_field(small_settings(), small_camera(), {}, [](const LightFieldDevicePlan& plan) {
    return std::make_unique<FaultyDevice>(plan, FaultyDevice::Fault::is_never_sure);
  });
  for (std::uint64_t frame = 1; frame <= 2; ++frame) {
    expect_same(find(light_field, image.view()), find(cpu, image.view()));
    EXPECT_EQ(light_field.counts().device_unsure, frame);
  }
  EXPECT_FALSE(light_field.counts().device_failed);
}

TEST(LightFieldDevice, that_repeats_the_cpu_is_trusted) {
  const SmallPlan small;
  LightFieldCuda device(small.plan);
  const DeviceTrial trial = try_device(device, small.plan);
  EXPECT_EQ(trial.differs, "");
  EXPECT_GT(trial.cpu_ms, 0);
  EXPECT_GT(trial.device_ms, 0);
}

TEST(LightFieldDevice, that_differs_in_one_place_is_not_trusted) {
  using Fault = FaultyDevice::Fault;
  const SmallPlan small;
  const auto check = [&](Fault fault) {
    FaultyDevice device(small.plan, fault);
    return try_device(device, small.plan).differs;
  };
  EXPECT_EQ(check(Fault::fails_at_lit), "it fails at the threshold");
  EXPECT_EQ(check(Fault::fails_at_rays), "it fails at the rays");
  EXPECT_EQ(check(Fault::fails_at_reading), "it fails at the rays");
  EXPECT_EQ(check(Fault::fails_at_candidates), "it fails at the candidates");
  EXPECT_EQ(check(Fault::fails_at_particles), "it fails at a frame");
  EXPECT_EQ(check(Fault::moves_a_ray), "it finds other rays");
  EXPECT_EQ(check(Fault::loses_a_candidate), "it finds other candidates");
  EXPECT_EQ(check(Fault::moves_a_particle), "it finds other particles in a frame");
  EXPECT_EQ(check(Fault::is_never_sure), "it is unsure of all particles");
}

}  // namespace
}  // namespace rptv
