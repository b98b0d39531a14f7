// SPDX-License-Identifier: MIT
// What the light-field stage refuses, leaves out and counts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.hpp"
#include "reconstruct/light_field/light_field.hpp"
#include "tests/reconstruct/light_field/small_scene.hpp"

namespace rptv {
namespace {

using testing::paint;
using testing::PaintedImage;
using testing::small_camera;
using testing::small_settings;

TEST(LightField, survives_a_blinding_frame_and_counts_what_it_left_out) {
  PaintedImage blinding(small_camera());
  blinding.fill(60000);
  auto settings = small_settings();
  settings.counting = "coarse", settings.max_rays = 20000, settings.max_candidates = 1000, settings.max_particles = 20;
  LightField light_field(settings, small_camera(), {});
  Particles found(20);
  light_field.reconstruct(blinding.view(), found);
  EXPECT_EQ(light_field.counts().refused_pixels, 512U * 384U - 20000U);
  EXPECT_GT(light_field.counts().refused_candidates, 0U);
  EXPECT_EQ(light_field.losses().of(LossCause::ray_overflow), light_field.counts().refused_pixels);
  EXPECT_EQ(light_field.losses().of(LossCause::candidate_overflow), light_field.counts().refused_candidates);
  EXPECT_EQ(light_field.losses().of(LossCause::particle_overflow), light_field.counts().refused_particles);
  const auto truth = testing::scatter(5, 1.5, 1.0, -15, 10, 0.9, 3);
  light_field.reconstruct(paint(truth).view(), found);
  EXPECT_EQ(found.size(), 5U);
}

TEST(LightField, refuses_images_that_are_not_its_own) {
  LightField light_field(small_settings(), small_camera(), {});
  PaintedImage other(small_camera(256, 384));
  Particles found(512);
  found.push({});
  light_field.reconstruct(other.view(), found);
  EXPECT_EQ(found.size(), 0U);
  light_field.reconstruct(FrameSet{}, found);
  light_field.reconstruct(ImageView{}, found);
  EXPECT_EQ(light_field.counts().refused_frames, 3U);
  EXPECT_EQ(light_field.losses().of(LossCause::frame_refused), 3U);
  EXPECT_EQ(light_field.counts().frames, 0U);
}

std::string refusal_of(const LightFieldSettings& settings, const LightFieldCalibration& camera) {
  try {
    const LightField light_field(settings, camera, {});
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::configuration);
    return error.what();
  }
  return "taken";
}

TEST(LightField, refuses_settings_that_contradict_the_camera) {
  using ::testing::HasSubstr;
  auto settings = small_settings();
  settings.particle_radius_um = 0;
  EXPECT_THAT(refusal_of(settings, small_camera()), HasSubstr("particle_radius_um"));
  settings.particle_radius_um = 1;
  EXPECT_THAT(refusal_of(settings, small_camera()), HasSubstr("eq. (7)"));
  settings = small_settings(), settings.volume_z_mm = {5, -5};
  EXPECT_THAT(refusal_of(settings, small_camera()), HasSubstr("volume_z_mm"));
  settings = small_settings(), settings.volume_z_mm = {-5, 70};
  EXPECT_THAT(refusal_of(settings, small_camera()), HasSubstr("volume_z_mm"));
  settings = small_settings(), settings.voxel_um = {1, 1, 1}, settings.counting = "exhaustive";
  EXPECT_THAT(refusal_of(settings, small_camera()), HasSubstr("voxel_um"));
  settings = small_settings(), settings.volume_x_mm = {1};
  EXPECT_THAT(refusal_of(settings, small_camera()), HasSubstr("volume_x_mm"));
  settings = small_settings(), settings.classification = "dbscan";
  EXPECT_THAT(refusal_of(settings, small_camera()), HasSubstr("coarse_to_fine"));
  const PaintedImage wrong(small_camera(100, 100));
  EXPECT_THROW(LightField(small_settings(), small_camera(), wrong.view()), Error);
}

TEST(LightField, takes_its_minimum_count_from_equation_7) {
  EXPECT_EQ(min_count_by_eq7(small_camera(), 15), std::floor(0.5 * std::pow(15 * 2.5 / 9, 2) * 3.14159265358979));
  EXPECT_EQ(LightField(small_settings(), small_camera(), {}).min_count(), 27);
  auto settings = small_settings();
  settings.min_count = 41;
  EXPECT_EQ(LightField(settings, small_camera(), {}).min_count(), 41);
}

}  // namespace
}  // namespace rptv
