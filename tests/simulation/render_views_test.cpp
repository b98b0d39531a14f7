// SPDX-License-Identifier: MIT
// Rigs of several cameras: the challenge's geometry, particle images where and as bright as they should be, its files.
#include "simulation/render_views.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "calibration/space_algebra.hpp"
#include "core/error.hpp"
#include "simulation/challenge_rig.hpp"
#include "simulation/lpt_points.hpp"
#include "simulation/wave_flow.hpp"

namespace rptv {
namespace {

ScenarioSettings small_scenario() {
  ScenarioSettings s;
  s.views = {"lpt_challenge", 0.1, 0.01, 0.8};
  s.flow.kind = "random";
  s.seeding.volume_x_mm = 100, s.seeding.volume_y_mm = 50, s.seeding.volume_z_mm = 30;
  s.seeding.photoelectrons = 5000;
  return s;
}

Tracer at(double x, double y, double z) {
  Tracer tracer;
  tracer.position = {x, y, z};
  return tracer;
}

TEST(ChallengeRig, four_cameras_see_the_whole_volume_from_600_mm) {
  const Rig rig = challenge_rig();
  ASSERT_EQ(rig.cameras.size(), 4U);
  for (const RigCamera& camera : rig.cameras) {
    const CameraModel& model = camera.model;
    EXPECT_NEAR(norm(model.centre_mm()), 600, 1e-9);
    EXPECT_NEAR(std::abs(std::atan2(model.centre_mm()[0], model.centre_mm()[2])), std::numbers::pi / 6, 1e-12);
    EXPECT_NEAR(std::abs(std::asin(model.centre_mm()[1] / 600)), std::numbers::pi / 18, 1e-12);
    for (int corner = 0; corner < 8; ++corner) {
      const auto pixel =
          model.project({corner & 1 ? 50.0 : -50.0, corner & 2 ? 25.0 : -25.0, corner & 4 ? 15.0 : -15.0});
      ASSERT_TRUE(pixel);
      EXPECT_TRUE(model.in_image(*pixel)) << (*pixel)[0] << ' ' << (*pixel)[1];
    }
    EXPECT_LT((*model.project({0, 10, 0}))[1], (*model.project({0, -10, 0}))[1]) << "rows grow downwards";
  }
}

TEST(ChallengeRig, a_part_of_the_sensor_keeps_scale_and_particles_per_pixel) {
  const ScenarioSettings half = fitted_to_rig(small_scenario(), rig_of(small_scenario()));
  EXPECT_EQ(half.camera.width_px, 192);
  EXPECT_EQ(half.camera.height_px, 120);
  EXPECT_NEAR(half.seeding.volume_x_mm, 10, 1e-12);
  EXPECT_EQ(half.seeding.particles, 230);
  EXPECT_EQ(challenge_rig(0.1).cameras[2].model.intrinsics().fx_px,
            challenge_rig().cameras[2].model.intrinsics().fx_px);
}

TEST(ViewRenderer, a_particles_image_is_a_gaussian_at_its_projection) {
  ScenarioSettings s = small_scenario();
  s.camera.noise = false;
  const CameraModel model = challenge_rig(0.1).cameras[0].model;
  ViewRenderer renderer(s, model, 0);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  const std::vector<Tracer> tracers{at(1.3, -0.7, 2.1)};
  renderer.render(tracers, 0, pixels);
  const Pixel expected = *model.project({1.3, -0.7, 2.1});
  double sum = 0, x = 0, y = 0, xx = 0;
  for (std::uint32_t row = 0; row < renderer.shape().height_px; ++row)
    for (std::uint32_t column = 0; column < renderer.shape().width_px; ++column) {
      const double light = renderer.expected()[row * renderer.shape().width_px + column];
      sum += light, x += light * column, y += light * row;
      xx += light * (column - expected[0]) * (column - expected[0]);
    }
  EXPECT_NEAR(sum, 5000, 0.1);
  EXPECT_NEAR(x / sum, expected[0], 1e-3);
  EXPECT_NEAR(y / sum, expected[1], 1e-3);
  EXPECT_NEAR(xx / sum, 0.8 * 0.8 + 1.0 / 12, 1e-3) << "the pixel's own width adds a twelfth";
  EXPECT_TRUE(renderer.views()[0].in_view);
  EXPECT_EQ(renderer.views()[0].pixel, expected);
}

TEST(ViewRenderer, images_depend_on_seed_camera_and_frame_alone) {
  const ScenarioSettings s = fitted_to_rig(small_scenario(), challenge_rig(0.1));
  const CameraModel model = challenge_rig(0.1).cameras[0].model;
  const auto tracers = Tracers(s).lit(3);
  EXPECT_EQ(tracers.size(), 230U);
  const auto image = [&](std::uint64_t camera, std::uint64_t frame, std::int64_t seed) {
    ScenarioSettings mine = s;
    mine.seed = seed;
    ViewRenderer renderer(mine, model, camera);
    std::vector<std::byte> pixels(renderer.shape().bytes());
    renderer.render(tracers, 0, pixels);  // an earlier frame leaves nothing behind
    renderer.render(tracers, frame, pixels);
    return pixels;
  };
  const auto first = image(0, 3, 1);
  EXPECT_EQ(first, image(0, 3, 1));
  EXPECT_NE(first, image(1, 3, 1));
  EXPECT_NE(first, image(0, 4, 1));
  EXPECT_NE(first, image(0, 3, 2));
}

TEST(ViewRenderer, every_depth_of_grey_is_rendered) {
  for (const std::int64_t bits : {8, 10, 12, 16}) {
    ScenarioSettings s = small_scenario();
    s.camera.bits = bits, s.camera.gain_e_per_dn = 0.01, s.camera.black_level_dn = 0;
    ViewRenderer renderer(s, challenge_rig(0.1).cameras[1].model, 1);
    EXPECT_EQ(renderer.shape().bytes_per_pixel, bits > 8 ? 2U : 1U);
    std::vector<std::byte> pixels(renderer.shape().bytes());
    renderer.render(std::vector<Tracer>{at(0, 0, 0)}, 0, pixels);
    const ImageView view{pixels.data(), renderer.shape()};
    std::uint32_t brightest = 0;
    for (std::size_t i = 0; i < view.shape.pixels(); ++i)
      brightest = std::max<std::uint32_t>(brightest, bits > 8 ? view.as_u16()[i] : view.as_u8()[i]);
    EXPECT_EQ(brightest, (1U << bits) - 1) << "saturated";
  }
}

TEST(ViewRenderer, what_is_off_the_sensor_or_behind_it_leaves_no_light) {
  ViewRenderer renderer(small_scenario(), challenge_rig(0.1).cameras[0].model, 0);
  std::vector<std::byte> pixels(renderer.shape().bytes());
  renderer.render(std::vector<Tracer>{at(500, 0, 0), at(-400, 0, 5000)}, 0, pixels);
  EXPECT_EQ(std::accumulate(renderer.expected().begin(), renderer.expected().end(), 0.0), 0);
  EXPECT_FALSE(renderer.views()[0].in_view);
  EXPECT_FALSE(renderer.views()[1].in_view);
}

TEST(WaveFlow, the_velocity_is_the_derivative_of_the_position_and_no_particle_is_faster_than_said) {
  FlowSettings drift;
  drift.drift_x_mm_s = 300, drift.drift_z_mm_s = -20;
  const WaveFlow flow({1.5, 25, 20}, drift, 7);
  double squares = 0;
  int count = 0;
  for (double x = -40; x <= 40; x += 8)
    for (const double t : {0.0, 0.013, 0.31}) {
      const Vector3 rest{x, 0.3 * x + 2, -0.2 * x};
      const double h = 1e-5;
      const Vector3 a = flow.position(rest, t - h), b = flow.position(rest, t + h), v = flow.velocity(rest, t);
      EXPECT_NEAR(v.x, (b.x - a.x) / (2 * h), 1e-3);
      EXPECT_NEAR(v.y, (b.y - a.y) / (2 * h), 1e-3);
      EXPECT_NEAR(v.z, (b.z - a.z) / (2 * h), 1e-3);
      EXPECT_LE(std::hypot(v.x, v.y, v.z), flow.fastest_mm_s());
      const Vector3 at = flow.position(rest, t);
      squares += (at.y - rest.y) * (at.y - rest.y), ++count;
    }
  EXPECT_NEAR(std::sqrt(squares / count), 1.5, 0.6);
}

TEST(LptPoints, read_back_bit_for_bit_and_past_a_title) {
  const std::vector<LptPoint> points{{{0.1, -2, 1.0 / 3}, {{1.5, 2.25}, {std::nan(""), std::nan("")}}},
                                     {{4, 5, 6}, {{1e-7, 1199.123456789}, {7, 8}}}};
  const std::string text = lpt_points_text(points);
  EXPECT_EQ(text.substr(0, text.find('\n')), "0.1 -2 0.3333333333333333 1.5 2.25 nan nan");
  const auto back = parse_lpt_points("X Y Z x1 y1 x2 y2\n# a remark\n" + text, "points.txt");
  ASSERT_EQ(back.size(), 2U);
  EXPECT_EQ(back[0].position_mm, points[0].position_mm);
  EXPECT_EQ(back[1].pixels, points[1].pixels);
  EXPECT_TRUE(std::isnan(back[0].pixels[1][0]));
}

TEST(LptPoints, say_which_line_is_wrong) {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parse_lpt_points(text, "points.txt");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_TRUE(refusal("1 2 3 4 5\n1 2 3 4\n").starts_with("points.txt:2: has 4 numbers"));
  EXPECT_TRUE(refusal("1 2 3 4 5\n1 2 3 4 5 6 7\n").starts_with("points.txt:2: has 7 numbers"));
  EXPECT_TRUE(refusal("1 2 3 4 5\n\n1 2 three 4 5\n").starts_with("points.txt:3: 'three' is no number"));
  EXPECT_TRUE(refusal("inf 2 3 4 5\n").empty()) << "a title begins with a letter";
  EXPECT_TRUE(refusal("1 2 inf 4 5\n").starts_with("points.txt:1: a position is not finite"));
}

}  // namespace
}  // namespace rptv
