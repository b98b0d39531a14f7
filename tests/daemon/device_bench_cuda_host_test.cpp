// SPDX-License-Identifier: MIT
// What `bench --cuda` measures, on the CPU in the device's place: bytes and increments against plain counts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "core/error.hpp"
#include "daemon/device_bench.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/light_field/light_field_cuda.hpp"
#include "tests/cuda_host/device_limits.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

using ::testing::HasSubstr;
using testing::paint;
using testing::PaintedImage;
using testing::scene;
using testing::small_camera;

/// Passes everything on, and counts what goes through.
class CountingDevice final : public LightFieldDevice {
 public:
  CountingDevice(const LightFieldDevicePlan& plan, StageCosts& plain)
      : device_(plan),
        plain_(plain),
        grid_(plan.grid),
        lenslets_(plan.lattice.size()),
        lit_(plan.max_rays),
        found_(plan.max_rays, plan.lattice.size()) {}

  bool page_lock(std::span<std::byte> memory) noexcept override { return device_.page_lock(memory); }
  bool set_limit(const DarkLimit& limit) noexcept override { return device_.set_limit(limit); }
  bool find_lit_pixels(const ImageView& image, std::span<std::uint32_t> lit, std::size_t& found) noexcept override {
    const bool done = device_.find_lit_pixels(image, lit, found);
    const std::size_t bytes = image.shape.bytes(), lit_bytes = 4 * std::min(found, lit.size());
    of(plain_, CudaStage::upload).bytes += bytes;
    of(plain_, CudaStage::lit_pixels).bytes += bytes + lit_bytes;
    of(plain_, CudaStage::download).bytes += 4 + lit_bytes;
    return done;
  }
  bool find_rays(std::span<const std::uint32_t> lit, Rays& rays, std::size_t& refused) noexcept override {
    const bool done = device_.find_rays(lit, rays, refused);
    const std::size_t ray_bytes = rays.size * (sizeof(Ray) + 4 + 4), lenslet_bytes = 4 * (lenslets_ + 1);
    of(plain_, CudaStage::upload).bytes += lit.size_bytes() + 4;
    of(plain_, CudaStage::rays).bytes += lit.size_bytes() + ray_bytes + lenslet_bytes;
    of(plain_, CudaStage::rays).increments += 2 * rays.size;
    of(plain_, CudaStage::download).bytes += 8;
    rays_ = rays.size;
    return done;
  }
  // Lit pixels and rays as above, at once; the rest is the CPU's.
  bool submit(const ImageView& image, std::uint16_t, std::size_t) noexcept override {
    image_ = image;
    return true;
  }
  bool collect(DeviceFrame& frame) noexcept override {
    std::size_t refused = 0;
    if (!find_lit_pixels(image_, lit_, frame.lit_pixels) ||
        !find_rays({lit_.data(), std::min(frame.lit_pixels, lit_.size())}, found_, refused))
      return false;
    frame.rays = found_.size, frame.pixels = found_.pixels, frame.particles.sure = false;
    return true;
  }
  bool read_rays(Rays& rays) noexcept override {
    of(plain_, CudaStage::download).bytes += rays.size * (sizeof(Ray) + 4 + 4) + 4 * (lenslets_ + 1);
    return device_.read_rays(rays);
  }
  // All by find_candidates() and the CPU.
  bool find_particles(std::uint16_t, std::size_t, DeviceParticles& particles) noexcept override {
    particles.sure = false;
    return true;
  }
  bool find_candidates(std::span<const std::uint8_t> taken, std::uint16_t least, std::vector<Candidate>& candidates,
                       std::size_t& refused) noexcept override {
    const bool done = device_.find_candidates(taken, least, candidates, refused);
    const auto free =
        static_cast<std::size_t>(std::count(taken.begin(), taken.begin() + static_cast<std::ptrdiff_t>(rays_), 0));
    const auto planes = static_cast<std::size_t>(grid_.planes);
    const std::size_t voxel_bytes = 2 * planes * static_cast<std::size_t>(grid_.plane_size());
    of(plain_, CudaStage::upload).bytes += rays_;
    of(plain_, CudaStage::count).bytes += rays_ * (sizeof(Ray) + 1) + voxel_bytes;
    of(plain_, CudaStage::count).increments += free * planes;
    of(plain_, CudaStage::maxima).bytes += voxel_bytes + candidates.size() * sizeof(Candidate);
    of(plain_, CudaStage::download).bytes += 4 + candidates.size() * sizeof(Candidate);
    return done;
  }

 private:
  LightFieldCuda device_;
  StageCosts& plain_;
  VoxelGrid grid_;
  std::size_t lenslets_;
  std::size_t rays_ = 0;
  ImageView image_;
  std::vector<std::uint32_t> lit_;
  Rays found_;
};

LightFieldSettings settings_of_test() {
  LightFieldSettings settings = testing::small_settings();
  settings.max_rays = 12000;
  settings.explain_rounds = 2;  // the device does all that it may do, the CPU stops where one finds nothing
  return settings;
}

/// A reconstruction on the device, and plain counts of what it does where those are asked for.
struct Measured {
  explicit Measured(bool counts) {
    light_field.emplace(settings_of_test(), small_camera(), ImageView{},
                        [&](const LightFieldDevicePlan& p) -> std::unique_ptr<LightFieldDevice> {
                          if (counts) return std::make_unique<CountingDevice>(p, plain);
                          return std::make_unique<LightFieldCuda>(p);
                        });
  }
  StageTimer timer;
  StageCosts plain{};
  std::optional<LightField> light_field;
  DeviceBench bench{timer};
  Particles found{512};

  void round(const ImageView& image) {
    bench.round([&] { light_field->reconstruct(image, found); });
  }
};

TEST(DeviceBench, counts_bytes_and_increments_as_plain_loops_do) {
  Measured measured(true);
  for (unsigned seed = 1; seed <= 3; ++seed) measured.round(paint(scene(seed)).view());
  EXPECT_EQ(measured.light_field->counts().rounds, 2U);  // rays were taken
  EXPECT_GT(of(measured.plain, CudaStage::count).increments, 10000U);
  for (std::size_t s = 1; s < kCudaStages; ++s) {
    const auto stage = static_cast<CudaStage>(s);
    const StageCost& sum = measured.bench.result().stages[s].sum;
    EXPECT_EQ(2 * sum.bytes, of(measured.plain, stage).bytes) << name_of(stage);  // of the plain half, too
    EXPECT_EQ(2 * sum.increments, of(measured.plain, stage).increments) << name_of(stage);
  }
  for (const CudaStage stage : {CudaStage::upload, CudaStage::lit_pixels, CudaStage::rays, CudaStage::count,
                                CudaStage::maxima, CudaStage::download})
    EXPECT_GT(measured.bench.result().stages[static_cast<std::size_t>(stage)].sum.device_ms, 0) << name_of(stage);
  EXPECT_EQ(measured.bench.result().latency_ns.count(), 3U);
}

TEST(DeviceBench, counts_the_same_where_the_device_explains_the_rays) {
  StageCosts plain;
  {
    Measured measured(true);
    for (unsigned seed = 1; seed <= 2; ++seed) measured.round(paint(scene(seed)).view());
    plain = measured.plain;
  }
  Measured measured(false);
  for (unsigned seed = 1; seed <= 2; ++seed) measured.round(paint(scene(seed)).view());
  EXPECT_EQ(measured.light_field->counts().device_unsure, 0U);
  for (const CudaStage stage : {CudaStage::lit_pixels, CudaStage::rays, CudaStage::count, CudaStage::maxima}) {
    const StageCost& sum = measured.bench.result().stages[static_cast<std::size_t>(stage)].sum;
    EXPECT_EQ(2 * sum.bytes, of(plain, stage).bytes) << name_of(stage);
    EXPECT_EQ(2 * sum.increments, of(plain, stage).increments) << name_of(stage);
  }
  EXPECT_GT(measured.bench.result().stages[static_cast<std::size_t>(CudaStage::fits)].sum.device_ms, 0);
}

TEST(DeviceBench, changes_no_result) {
  const PaintedImage image = paint(scene(4));
  Measured measured(false);
  measured.round(image.view());
  LightField cpu(settings_of_test(), small_camera(), {});
  Particles expected(512);
  cpu.reconstruct(image.view(), expected);
  EXPECT_GT(expected.size(), 2U);
  EXPECT_EQ(measured.found.x_mm, expected.x_mm);
  EXPECT_EQ(measured.found.z_mm, expected.z_mm);
  EXPECT_EQ(measured.found.residual_mm, expected.residual_mm);
}

TEST(DeviceBench, says_when_the_device_does_not_do_its_part) {
  StageTimer timer;
  DeviceBench bench(timer);
  EXPECT_THROW(bench.round([] {}), Error);
  EXPECT_EQ(bench.result().latency_ns.count(), 0U);
}

TEST(DeviceBench, reports_a_table_and_json_beside_the_limits_of_the_device) {
  DeviceBenchResult result;
  for (const std::int64_t ns : {2'000'000, 2'000'000}) result.latency_ns.record(ns);
  DeviceStageTimes& count = result.stages[static_cast<std::size_t>(CudaStage::count)];
  for (int round = 0; round < 2; ++round) count.device_ns.record(500'000);
  count.sum = {1.0, 64'000'000, 576'000'000};  // ms, bytes, increments of both rounds
  const CudaDeviceLimits limits = ask_cuda_device_limits();
  EXPECT_EQ(limits.memory_bytes_per_s(), 128e9);  // 2 · 2 GHz · 256 bit / 8
  EXPECT_EQ(limits.increments_per_s(), 1152e9);   // 36 · 1 GHz · 32
  const std::string text = to_text(result, limits), json = to_json(result, limits);
  EXPECT_THAT(text, HasSubstr("at most 128 GB/s and 1152 G increments/s; CUDA 13.0"));
  EXPECT_THAT(text, HasSubstr("2 rounds from image to particles, copies included: P50 2.000, P99 2.000"));
  EXPECT_THAT(text, HasSubstr("  count                     0.500    0.500     32.000     64.0  50.0 %    288000000   "
                              "576.00  50.0 %\n"));
  EXPECT_THAT(json, HasSubstr(R"("memory_bytes_per_s":1.28e+11,"increments_per_s":1.152e+12,"rounds":2,)"));
  EXPECT_THAT(json, HasSubstr(R"("stages":[{"stage":"count","device_ns":{"p50":500000,"p99":500000,"p99_9":500000,)"
                              R"("max":500000},"bytes":32000000,"increments":288000000,"bytes_per_s":6.4e+10,)"
                              R"("increments_per_s":5.76e+11}]})"));
}

TEST(DeviceBench, reports_no_rates_where_clocks_or_times_are_not_known) {
  DeviceBenchResult result;
  result.latency_ns.record(1);
  result.stages[static_cast<std::size_t>(CudaStage::upload)].sum = {0, 1000, 0};
  const std::string json = to_json(result, {});
  EXPECT_THAT(json, HasSubstr(R"("clock_hz":null,"memory_bytes_per_s":null,"increments_per_s":null)"));
  EXPECT_THAT(json, HasSubstr(R"("bytes":1000,"increments":0,"bytes_per_s":null,"increments_per_s":null)"));
  EXPECT_THAT(to_text(result, {}), HasSubstr("at most - GB/s and - G increments/s"));
}

}  // namespace
}  // namespace rptv
