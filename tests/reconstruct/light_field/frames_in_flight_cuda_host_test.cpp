// SPDX-License-Identifier: MIT
// Two light-field frames in flight on the device, run on the CPU, and frames as recorded graphs: the same particles.
#include <gtest/gtest.h>

#include <cstring>

#include "reconstruct/light_field/light_field.hpp"
#include "reconstruct/light_field/light_field_cuda.hpp"
#include "tests/cuda_host/control.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

LightFieldSettings settings_for_rays(std::int64_t rays) {
  LightFieldSettings settings = testing::small_settings();
  settings.max_rays = rays;
  settings.max_particles = 150;  // fewer warps without work, which take their time here, too
  return settings;
}

MakeLightFieldDevice make_cuda(bool graph) {
  return [graph](const LightFieldDevicePlan& plan) { return std::make_unique<LightFieldCuda>(plan, graph); };
}

/// A reconstructor, and the columns of what it finds.
struct Side {
  Side(const LightFieldSettings& settings, const MakeLightFieldDevice& make_device)
      : light_field(settings, testing::small_camera(), {}, make_device) {}
  Particles collect() {
    Particles found(512);
    light_field.collect(found);
    return found;
  }
  Particles find(const ImageView& image) {
    light_field.submit(image);
    return collect();
  }
  LightField light_field;
};

bool same(const Particles& a, const Particles& b) {
  return a.x_mm == b.x_mm && a.y_mm == b.y_mm && a.z_mm == b.z_mm && a.support == b.support &&
         a.residual_mm == b.residual_mm && a.covariance_mm2 == b.covariance_mm2;
}

TEST(LightFieldInFlight, is_one_frame_on_the_cpu_and_two_on_a_device) {
  EXPECT_EQ(Side(settings_for_rays(12000), nullptr).light_field.most_in_flight(), 1U);
  EXPECT_EQ(Side(settings_for_rays(12000), make_cuda(true)).light_field.most_in_flight(), 2U);
  auto refined = settings_for_rays(12000);
  refined.refine = true;
  EXPECT_EQ(Side(refined, make_cuda(true)).light_field.most_in_flight(), 1U);
}

TEST(LightFieldInFlight, gives_each_frame_its_particles_in_order_and_allocates_nothing) {
  for (const bool graph : {true, false}) {
    auto settings = settings_for_rays(12000);
    settings.running_background = true;
    Side cpu(settings, nullptr), device(settings, make_cuda(graph));
    std::vector<testing::PaintedImage> images;
    for (unsigned seed = 1; seed <= 3; ++seed) images.push_back(testing::paint(testing::scene(seed)));
    std::vector<Particles> expected;
    for (const auto& image : images) expected.push_back(cpu.find(image.view()));
    const std::size_t bytes = cuda_host::device_bytes_in_use();
    device.light_field.submit(images[0].view());
    for (std::size_t frame = 0; frame < images.size(); ++frame) {
      if (frame + 1 < images.size()) device.light_field.submit(images[frame + 1].view());
      EXPECT_TRUE(same(device.collect(), expected[frame])) << frame << ", graph " << graph;
    }
    EXPECT_EQ(device.light_field.counts().frames, images.size());
    EXPECT_FALSE(device.light_field.counts().device_failed);
    EXPECT_EQ(cuda_host::device_bytes_in_use(), bytes);
  }
}

TEST(LightFieldInFlight, refuses_a_frame_between_others_and_counts_it) {
  Side cpu(settings_for_rays(12000), nullptr), device(settings_for_rays(12000), make_cuda(true));
  const testing::PaintedImage image = testing::paint(testing::scene(5)), other(testing::small_camera(256, 384));
  const Particles expected = cpu.find(image.view());
  device.light_field.submit(image.view());
  device.light_field.submit(other.view());
  EXPECT_TRUE(same(device.collect(), expected));
  device.light_field.submit(image.view());
  EXPECT_EQ(device.collect().size(), 0U);
  EXPECT_TRUE(same(device.collect(), expected));
  EXPECT_EQ(device.light_field.losses().of(LossCause::frame_refused), 1U);
}

TEST(LightFieldInFlight, records_again_when_images_have_other_pixels) {
  Side cpu(settings_for_rays(12000), nullptr), device(settings_for_rays(12000), make_cuda(true));
  testing::PaintedImage image = testing::paint(testing::scene(6));
  std::vector<std::byte> narrow;
  for (const std::uint16_t grey : image.pixels()) narrow.push_back(static_cast<std::byte>(grey));
  const ImageView bytes{narrow.data(), {512, 384, 1}};
  for (const ImageView& view : {image.view(), bytes, bytes, image.view()})
    EXPECT_TRUE(same(device.find(view), cpu.find(view)));
  EXPECT_FALSE(device.light_field.counts().device_failed);
}

TEST(LightFieldInFlight, takes_more_turns_than_were_recorded_where_particles_crowd) {
  Side cpu(settings_for_rays(40000), nullptr), device(settings_for_rays(40000), make_cuda(true));
  const testing::PaintedImage image = testing::paint(testing::scatter(120, 1.9, 1.4, -20, 10, 0.15, 2));
  EXPECT_TRUE(same(device.find(image.view()), cpu.find(image.view())));
  EXPECT_EQ(device.light_field.counts().device_unsure, 0U);
}

// What happens to those who do not wait: streams of the executor run as late as they may.
TEST(LightFieldInFlight, shows_in_tests_when_an_image_is_refilled_too_early) {
  testing::PaintedImage image = testing::paint(testing::scene(7));
  const testing::PaintedImage before = image;
  Side cpu(settings_for_rays(12000), nullptr), device(settings_for_rays(12000), make_cuda(true));
  ASSERT_TRUE(device.light_field.page_lock(std::as_writable_bytes(std::span(image.pixels()))));
  const Particles expected = cpu.find(before.view());
  EXPECT_TRUE(same(device.find(image.view()), expected));
  device.light_field.submit(image.view());
  image.fill(0);
  EXPECT_FALSE(same(device.collect(), expected));
}

}  // namespace
}  // namespace rptv
